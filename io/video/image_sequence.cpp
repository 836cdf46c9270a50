#include "io/video/image_sequence.hpp"

#include <fmt/core.h>

#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "geometry/fields.hpp"

namespace stillkite {
namespace {

bool load(const std::filesystem::path& file, std::vector<unsigned char>& bytes) {
  std::ifstream stream(file, std::ios::binary | std::ios::ate);
  const std::streamoff size = stream.tellg();
  if (!stream || size <= 0) return false;
  bytes.resize(static_cast<std::size_t>(size));
  stream.seekg(0);
  return static_cast<bool>(stream.read(reinterpret_cast<char*>(bytes.data()), size));
}

}  // namespace

ReadResult ImageSequence::read(cv::Mat recycled) {
  if (at_ == images_.size()) return {};
  const StampedImage& image = images_[at_++];
  cv::Mat grey;
  try {
    if (load(image.file, bytes_)) {
      constexpr int kGrey =
          cv::IMREAD_GRAYSCALE | cv::IMREAD_ANYDEPTH | cv::IMREAD_IGNORE_ORIENTATION;
      grey = cv::imdecode(bytes_, kGrey, deep_.empty() ? &recycled : &deep_);
    }
  } catch (const cv::Exception&) {
    // invalid image size in the header
    grey.release();
  }
  if (grey.depth() != CV_8U && grey.depth() != CV_16U) grey.release();
  if (grey.empty()) return {.status = ReadResult::Status::undecodable};
  if (size_.area() > 0 && grey.size() != size_) {
    throw InputError(fmt::format(
        "{}: image size {}x{} differs from {}x{} before; one calibration needs one size",
        image.file.string(), grey.cols, grey.rows, size_.width, size_.height));
  }
  size_ = grey.size();
  if (grey.depth() == CV_16U) {
    const bool is_first = deep_.empty();
    deep_ = grey;
    grey = depth_.to_8_bits(deep_, {}, image.file.string(), is_first ? cv::Mat() : recycled);
  } else {
    depth_.check_8_bits(image.file.string());
    deep_.release();  // may share the returned buffer
  }
  return {.status = ReadResult::Status::frame, .frame = {.stamp = image.stamp, .grey = grey}};
}

}  // namespace stillkite
