#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "geometry/angle.hpp"

namespace stillkite {

/// Rigid 2-D registration: rotation about the image centre, then a translation.
struct ImageRegistration {
  Eigen::Vector2d shift_px = Eigen::Vector2d::Zero();  ///< translation of the centre
  double rotation_rad = 0;                             ///< from the x axis towards the y axis
  double correlation = 0;  ///< band-passed, over the overlap, in [-1, 1]
};

/// Sets of rotation hypotheses; the run time is proportional to their number.
inline constexpr std::array<double, 1> kNoRotation_rad = {0};
inline constexpr std::array<double, 7> kSmallRotations_rad = {
    -12 * kDegree, -8 * kDegree, -4 * kDegree, 0, 4 * kDegree, 8 * kDegree, 12 * kDegree};

/// Registers `current` to `reference` (CV_8UC1, same size) without an initial value, by masked
/// normalized cross-correlation (D. Padfield, "Masked object registration in the Fourier domain",
/// 2012, eq. 5 to 13). Covers every shift with an overlap of at least 25 % at each given rotation.
/// Works on copies of at most 160 px a side: a coarse initial value for a finer method.
/// `homography`: of pixels, fixes the centre, applied to both images first; the result is in the
/// warped pixels. Returns at most 3 registrations, best first; none for images without texture.
[[nodiscard]] std::vector<ImageRegistration> register_images(
    const cv::Mat& reference, const cv::Mat& current,
    const Eigen::Matrix3d& homography = Eigen::Matrix3d::Identity(),
    std::span<const double> rotations_rad = kSmallRotations_rad);

}  // namespace stillkite
