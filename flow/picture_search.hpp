#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace stillkite {

/// A picture that is another one turned about its middle and then shifted.
struct PictureShift {
  Eigen::Vector2d shift_px = Eigen::Vector2d::Zero();  ///< of the middle
  double turn_rad = 0;                                 ///< from the x axis to the y axis
  double correlation = 0;  ///< of what overlaps, -1..1, its slow changes of brightness removed
};

/// Which turns of the picture a search tries: most of its time goes into them.
enum class SearchedTurns { none, all };

/// Looks for `reference` in `current` (both CV_8UC1, of one size) without any first guess: the
/// normalised correlation at every shift that leaves a quarter of the picture in view, and at turns
/// of up to 12 degrees (or none), on copies of at most 160 px a side. Coarse, meant to start
/// something finer. Both are seen through `view` first, a homography of pixels that keeps the
/// middle; the answer is in its pixels. The most credible few, best first; none where a picture
/// shows nothing. (D. Padfield, "Masked object registration in the Fourier domain", 2012, eq. 5
/// to 13.)
[[nodiscard]] std::vector<PictureShift> find_shifts(
    const cv::Mat& reference, const cv::Mat& current,
    const Eigen::Matrix3d& view = Eigen::Matrix3d::Identity(),
    SearchedTurns turns = SearchedTurns::all);

}  // namespace stillkite
