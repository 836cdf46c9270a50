#include "io/video/image_sequence.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cmath>
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

// Conversion by the 8 most significant of the used bits.
cv::Mat ImageSequence::to_8_bits(const StampedImage& image, cv::Mat recycled) {
  constexpr int kMinDefaultBits = 15;
  if (!bits_) {
    double max_value = 0;
    cv::minMaxLoc(deep_, nullptr, &max_value);
    const int used_bits = std::bit_width(static_cast<unsigned>(max_value));
    if (used_bits < kMinDefaultBits) {
      throw InputError(fmt::format(
          "{}: 16-bit image with a maximum value of {}; set source.bits to the significant bits of "
          "the camera ({}, or 16 for a dark scene)",
          image.file.string(), max_value, std::max(used_bits, 8)));
    }
    bits_ = 16;
  }
  deep_.convertTo(recycled, CV_8U, std::ldexp(1.0, 8 - *bits_));
  return recycled;
}

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
    grey = to_8_bits(image, is_first ? cv::Mat() : recycled);
  } else if (bits_ && deep_.empty()) {
    throw InputError(
        fmt::format("{}: 8-bit image; source.bits is only for 16-bit images", image.file.string()));
  } else {
    deep_.release();  // may share the returned buffer
  }
  return {.status = ReadResult::Status::frame, .frame = {.stamp = image.stamp, .grey = grey}};
}

}  // namespace stillkite
