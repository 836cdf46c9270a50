#include "io/image_sequence.hpp"

#include <fmt/core.h>

#include <fstream>
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
      constexpr int kGrey = cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION;
      grey = cv::imdecode(bytes_, kGrey, &recycled);
    }
  } catch (const cv::Exception&) {
    // a header that promises an absurd size; no other picture is lost by it
    grey.release();
  }
  if (grey.empty()) return {.status = ReadResult::Status::undecodable};
  if (size_.area() > 0 && grey.size() != size_) {
    throw InputError(fmt::format(
        "{}: is {}x{}, the pictures before are {}x{}; one calibration cannot serve both",
        image.file.string(), grey.cols, grey.rows, size_.width, size_.height));
  }
  size_ = grey.size();
  return {.status = ReadResult::Status::frame, .frame = {.stamp = image.stamp, .grey = grey}};
}

}  // namespace stillkite
