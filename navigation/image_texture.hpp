#pragma once

#include <opencv2/core/mat.hpp>

namespace stillkite {

/// Share of the blocks of an image (CV_8UC1) that show texture: black, white, foggy, blurred and
/// sky-only images have next to none. Meant for a coarse level of a pyramid, where noise is
/// averaged away.
[[nodiscard]] double textured_share(const cv::Mat& grey);

/// Too little to measure a motion by.
[[nodiscard]] inline bool is_bare(const cv::Mat& grey) {
  constexpr double kLeastShare = 0.05;
  return textured_share(grey) < kLeastShare;
}

}  // namespace stillkite
