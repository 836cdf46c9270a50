#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>
#include <vector>

#include "io/import/ros_flight.hpp"
#include "io/results/output_file.hpp"

namespace stillkite {
namespace {

namespace fs = std::filesystem;

struct RosEncoding {
  std::string_view name;
  int type;  // of OpenCV
  int to_grey = -1;
};
constexpr std::array kRosEncodings{RosEncoding{"mono8", CV_8UC1},
                                   RosEncoding{"8UC1", CV_8UC1},
                                   RosEncoding{"mono16", CV_16UC1},
                                   RosEncoding{"16UC1", CV_16UC1},
                                   RosEncoding{"bgr8", CV_8UC3, cv::COLOR_BGR2GRAY},
                                   RosEncoding{"rgb8", CV_8UC3, cv::COLOR_RGB2GRAY},
                                   RosEncoding{"bgra8", CV_8UC4, cv::COLOR_BGRA2GRAY},
                                   RosEncoding{"rgba8", CV_8UC4, cv::COLOR_RGBA2GRAY},
                                   RosEncoding{"bayer_rggb8", CV_8UC1, cv::COLOR_BayerBG2GRAY},
                                   RosEncoding{"bayer_bggr8", CV_8UC1, cv::COLOR_BayerRG2GRAY},
                                   RosEncoding{"bayer_gbrg8", CV_8UC1, cv::COLOR_BayerGR2GRAY},
                                   RosEncoding{"bayer_grbg8", CV_8UC1, cv::COLOR_BayerGB2GRAY}};

// Encoded image of a message: extension and bytes; without bytes, the encoding is not supported.
struct ImageFile {
  const char* extension = nullptr;
  std::vector<std::uint8_t> bytes;
  std::string encoding;
};

// As recorded, if it is JPEG or PNG.
ImageFile compressed_image(RosFields& fields) {
  ImageFile out{.encoding = std::string(fields.text())};
  const Bytes data = fields.bytes();
  if (!fields.is_valid() || data.size() < 4) return out;
  if (data[0] == 0xFF && data[1] == 0xD8) out.extension = ".jpg";
  if (data[0] == 0x89 && data[1] == 'P') out.extension = ".png";
  if (out.extension != nullptr) out.bytes.assign(data.begin(), data.end());
  return out;
}

// As grey PNG.
ImageFile raw_image(RosFields& fields) {
  constexpr std::uint32_t kMaxSide_px = 32'768;
  const auto height = fields.next<std::uint32_t>(), width = fields.next<std::uint32_t>();
  ImageFile out{.extension = ".png", .encoding = std::string(fields.text())};
  const bool is_big_endian = fields.next<std::uint8_t>() != 0;
  const std::size_t step = fields.next<std::uint32_t>();
  const Bytes data = fields.bytes();
  if (!fields.is_valid() || width == 0 || height == 0) return out;
  if (width > kMaxSide_px || height > kMaxSide_px) return out;
  const auto* const known = std::ranges::find(kRosEncodings, out.encoding, &RosEncoding::name);
  if (known == kRosEncodings.end()) return out;
  if (step < width * CV_ELEM_SIZE(known->type) || data.size() / step < height) return out;
  if (CV_MAT_DEPTH(known->type) == CV_16U && is_big_endian) return out;
  std::vector<std::uint8_t> pixels(data.begin(), data.end());
  const cv::Mat image(static_cast<int>(height), static_cast<int>(width), known->type, pixels.data(),
                      step);
  cv::Mat grey = image;
  if (known->to_grey >= 0) cv::cvtColor(image, grey, known->to_grey);
  cv::imencode(".png", grey, out.bytes, {cv::IMWRITE_PNG_COMPRESSION, 1});
  return out;
}

// Size of the decoded image; empty if it is damaged.
cv::Size size_of(const ImageFile& image) {
  try {
    return cv::imdecode(image.bytes, cv::IMREAD_GRAYSCALE).size();
  } catch (const cv::Exception&) {  // larger than OpenCV's limit
    return {};
  }
}

class RosImageWriter {
 public:
  explicit RosImageWriter(fs::path folder)
      : folder_(std::move(folder)), list_(folder_ / "data.csv") {
    list_.write("#timestamp [ns],filename\n");
  }

  void take(const RosMessage& message) {
    RosFields fields(message);
    const Timestamp stamp = fields.header();
    const ImageFile image = message.type == "sensor_msgs/CompressedImage" ? compressed_image(fields)
                                                                          : raw_image(fields);
    cv::Size size(out_.width_px, out_.height_px);
    if (out_.written == 0 && !image.bytes.empty()) size = size_of(image);
    if (stamp <= last_ || image.bytes.empty() || size.empty()) {
      if (out_.rejected++ == 0) out_.encoding = image.encoding;
      return;
    }
    const std::string name = fmt::format("{:019}{}", stamp.ns, image.extension);
    write_file(folder_ / "data" / name,
               {reinterpret_cast<const char*>(image.bytes.data()), image.bytes.size()});
    list_.write(fmt::format("{},{}\n", stamp.ns, name));
    last_ = stamp;
    out_.width_px = size.width;
    out_.height_px = size.height;
    ++out_.written;
  }

  RosImages finish() {
    list_.commit();
    return out_;
  }

 private:
  fs::path folder_;
  OutputFile list_;
  Timestamp last_{-1};
  RosImages out_;
};

}  // namespace

RosImages write_ros_images(const fs::path& file, RecordingFormat format, const std::string& topic,
                           const fs::path& camera_folder, const std::function<void()>& poll) {
  fs::create_directories(camera_folder / "data");
  RosImageWriter writer(camera_folder);
  read_ros_messages(file, format, [&](const RosMessage& message) {
    poll();
    if (message.topic == topic) writer.take(message);
  });
  return writer.finish();
}

}  // namespace stillkite
