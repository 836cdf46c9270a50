#pragma once

#include <opencv2/core/mat.hpp>

#include "flow/pyramid.hpp"

namespace stillkite {

/// Ratio of textured blocks in an image (CV_8UC1), 0..1; near 0 for black, white, fog, blur and
/// sky. Intended for a coarse pyramid level, where noise is averaged out.
[[nodiscard]] double textured_ratio(const cv::Mat& grey);

/// True if the texture is insufficient for motion estimation.
[[nodiscard]] inline bool is_textureless(const cv::Mat& grey) {
  constexpr double kMinTexturedRatio = 0.05;
  return textured_ratio(grey) < kMinTexturedRatio;
}

/// Pyramid level on which `is_textureless` is tested.
[[nodiscard]] const cv::Mat& texture_level(const Pyramid& pyramid);

}  // namespace stillkite
