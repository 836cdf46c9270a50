#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "flow/tile_flow.hpp"

// Square patch around a feature: one tile of TileFlow.

namespace stillkite {

inline constexpr int kPatch_px = 16;
inline constexpr float kPatchPixels = kPatch_px * kPatch_px;
/// Minimum eigenvalue of the structure tensor, above that of 1 to 2 grey levels of noise.
inline constexpr float kMinEigenvalue = kPatchPixels / 2;

/// One tile per feature, at the nearest integer position inside the image. `scale`: of the image
/// relative to that of `centres_px`.
[[nodiscard]] TileGrid patch_grid(const std::vector<Eigen::Vector2f>& centres_px, float scale,
                                  const cv::Mat& image);

[[nodiscard]] inline float determinant_of(const TileMeasurements& m, std::size_t i) {
  return m.gxx[i] * m.gyy[i] - m.gxy[i] * m.gxy[i];
}

[[nodiscard]] inline float min_eigenvalue(const TileMeasurements& m, std::size_t i) {
  const float half_trace = 0.5F * (m.gxx[i] + m.gyy[i]);
  return half_trace - std::sqrt(std::max(0.0F, half_trace * half_trace - determinant_of(m, i)));
}

/// Lucas-Kanade step, G u = g, of one patch, at most 3 px long; zero without sufficient texture.
[[nodiscard]] inline Eigen::Vector2f patch_step_px(const TileMeasurements& m, std::size_t i) {
  constexpr float kMaxStep_px = 3;
  if (min_eigenvalue(m, i) < kMinEigenvalue) return Eigen::Vector2f::Zero();
  const float determinant = determinant_of(m, i);
  const Eigen::Vector2f u((m.gyy[i] * m.gx[i] - m.gxy[i] * m.gy[i]) / determinant,
                          (m.gxx[i] * m.gy[i] - m.gxy[i] * m.gx[i]) / determinant);
  const float length = u.norm();
  return length > kMaxStep_px ? (u * (kMaxStep_px / length)).eval() : u;
}

/// Normalized correlation of reference and current patch, before the last step; -1 if undefined.
[[nodiscard]] inline float patch_correlation(const TileMeasurements& m, std::size_t i) {
  const float current = m.contrast[i] - 2 * m.gain_product[i] + m.residual[i];
  // textureless patches: below the rounding error of the sums
  constexpr float kRounding = 1e-4F;
  if (!(m.contrast[i] > 0 && current > kRounding * m.contrast[i])) return -1;
  return (m.contrast[i] - m.gain_product[i]) / std::sqrt(m.contrast[i] * current);
}

}  // namespace stillkite
