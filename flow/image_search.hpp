#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "geometry/angle.hpp"

namespace stillkite {

/// An image that is another one turned about its middle and then shifted.
struct ImageShift {
  Eigen::Vector2d shift_px = Eigen::Vector2d::Zero();  ///< of the middle
  double turn_rad = 0;                                 ///< from the x axis to the y axis
  double correlation = 0;  ///< of what overlaps, -1..1, its slow changes of brightness removed
};

/// The turns of the image that a search tries: its time grows with their number.
inline constexpr std::array<double, 1> kNoTurn_rad = {0};
inline constexpr std::array<double, 7> kSlightTurns_rad = {
    -12 * kDegree, -8 * kDegree, -4 * kDegree, 0, 4 * kDegree, 8 * kDegree, 12 * kDegree};

/// Looks for `reference` in `current` (both CV_8UC1, of one size) without any first guess: the
/// normalised correlation at every shift that leaves a quarter of the image in view, and at every
/// given turn, on copies of at most 160 px a side. Coarse, meant to start something finer. Both are
/// seen through `view` first, a homography of pixels that keeps the middle; the answer is in its
/// pixels. The most credible few, best first; none where an image shows nothing. (D. Padfield,
/// "Masked object registration in the Fourier domain", 2012, eq. 5 to 13.)
[[nodiscard]] std::vector<ImageShift> find_shifts(
    const cv::Mat& reference, const cv::Mat& current,
    const Eigen::Matrix3d& view = Eigen::Matrix3d::Identity(),
    std::span<const double> turns_rad = kSlightTurns_rad);

}  // namespace stillkite
