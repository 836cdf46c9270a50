#include "io/video/grey_depth.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <opencv2/core.hpp>

#include "geometry/fields.hpp"

namespace stillkite {

cv::Mat GreyDepth::to_8_bits(const cv::Mat& samples, const SampleBits& layout,
                             const std::string& name, cv::Mat recycled) {
  constexpr int kMinDefaultBits = 15;
  if (bits_ && *bits_ > layout.depth) {
    throw InputError(
        fmt::format("{}: {}-bit image; source.bits of {} is out of range, allowed: 8 to {}", name,
                    layout.depth, *bits_, layout.depth));
  }
  if (!bits_ && layout.depth >= kMinDefaultBits && !checked_) {
    double max_value = 0;
    cv::minMaxLoc(samples, nullptr, &max_value);
    const int used_bits = std::bit_width(static_cast<unsigned>(max_value));
    if (used_bits < kMinDefaultBits) {
      throw InputError(fmt::format(
          "{}: 16-bit image with a maximum value of {}; set source.bits to the significant bits of "
          "the camera ({}, or 16 for a dark scene)",
          name, max_value, std::max(used_bits, 8)));
    }
  }
  checked_ = true;
  const int bits = bits_.value_or(layout.depth);
  samples.convertTo(recycled, CV_8U, std::ldexp(1.0, 8 - bits - layout.shift));
  return recycled;
}

void GreyDepth::check_8_bits(const std::string& name) const {
  if (!bits_ || checked_) return;
  throw InputError(fmt::format(
      "{}: 8-bit image; source.bits is only for images of more than 8 bits, remove it", name));
}

}  // namespace stillkite
