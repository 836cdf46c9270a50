#include <fmt/core.h>

#include <array>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
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

// Encoded image of a message: extension and bytes.
struct ImageFile {
  const char* extension;
  std::vector<std::uint8_t> bytes;
};

// As recorded, if it is JPEG or PNG.
std::optional<ImageFile> compressed_image(RosFields& fields) {
  (void)fields.text();
  const Bytes data = fields.bytes();
  if (!fields.is_valid() || data.size() < 4) return std::nullopt;
  const std::vector<std::uint8_t> bytes(data.begin(), data.end());
  if (bytes[0] == 0xFF && bytes[1] == 0xD8) return ImageFile{".jpg", bytes};
  if (bytes[0] == 0x89 && bytes[1] == 'P') return ImageFile{".png", bytes};
  return std::nullopt;
}

// As grey PNG.
std::optional<ImageFile> raw_image(RosFields& fields) {
  constexpr std::uint32_t kMaxSide_px = 32'768;
  const auto height = fields.next<std::uint32_t>(), width = fields.next<std::uint32_t>();
  const std::string_view encoding = fields.text();
  const bool is_big_endian = fields.next<std::uint8_t>() != 0;
  const std::size_t step = fields.next<std::uint32_t>();
  const Bytes data = fields.bytes();
  if (!fields.is_valid() || width == 0 || height == 0) return std::nullopt;
  if (width > kMaxSide_px || height > kMaxSide_px) return std::nullopt;
  for (const RosEncoding& known : kRosEncodings) {
    if (known.name != encoding) continue;
    const bool is_wide = CV_MAT_DEPTH(known.type) == CV_16U;
    if (step < width * CV_ELEM_SIZE(known.type) || data.size() / step < height) return std::nullopt;
    if (is_wide && is_big_endian) return std::nullopt;
    std::vector<std::uint8_t> pixels(data.begin(), data.end());
    const cv::Mat image(static_cast<int>(height), static_cast<int>(width), known.type,
                        pixels.data(), step);
    cv::Mat grey = image;
    if (known.to_grey >= 0) cv::cvtColor(image, grey, known.to_grey);
    ImageFile out{".png", {}};
    cv::imencode(".png", grey, out.bytes, {cv::IMWRITE_PNG_COMPRESSION, 1});
    return out;
  }
  return std::nullopt;
}

}  // namespace

std::size_t write_ros_images(const fs::path& file, RecordingFormat format, const std::string& topic,
                             const fs::path& camera_folder) {
  fs::create_directories(camera_folder / "data");
  OutputFile list(camera_folder / "data.csv");
  list.write("#timestamp [ns],filename\n");
  std::size_t images = 0;
  Timestamp last{-1};
  read_ros_messages(file, format, [&](const RosMessage& message) {
    if (message.topic != topic) return true;
    RosFields fields(message);
    const Timestamp stamp = fields.header();
    if (stamp <= last) return true;
    const std::optional<ImageFile> image = message.type == "sensor_msgs/CompressedImage"
                                               ? compressed_image(fields)
                                               : raw_image(fields);
    if (!image) return true;
    const std::string name = fmt::format("{:019}{}", stamp.ns, image->extension);
    write_file(camera_folder / "data" / name,
               {reinterpret_cast<const char*>(image->bytes.data()), image->bytes.size()});
    list.write(fmt::format("{},{}\n", stamp.ns, name));
    last = stamp;
    ++images;
    return true;
  });
  list.commit();
  return images;
}

}  // namespace stillkite
