#pragma once

#include <span>

#include "estimation/two_view/epipolar_error.hpp"
#include "estimation/two_view/relative_pose_config.hpp"

namespace stillkite {

/// The essential matrix that explains most pairs.
struct EssentialFit {
  RelativePose pose;  ///< any of the four that share E
  double cost = 0;    ///< sum of min(e^2 / threshold^2, 1)
  int inliers = 0;    ///< pairs below the threshold
  bool found = false;
};

/// Locally optimised RANSAC with truncated squares (Chum, Matas and Kittler 2003; Torr and
/// Zisserman 2000, MSAC): each best model so far is refined on all pairs before the next draw. The
/// `starts` are refined first, and one that `explains` the pairs ends the search. `threshold` on z
/// = 1.
[[nodiscard]] EssentialFit fit_essential(const BearingColumns& columns, double threshold,
                                         const RelativePoseConfig& config,
                                         std::span<const RelativePose> starts);

/// A pose that is off by some degrees, refined on all pairs.
[[nodiscard]] EssentialFit optimise_start(const BearingColumns& columns, const RelativePose& start,
                                          double threshold);

/// Whether a model stands as a fresh one would: at least a quarter of the pairs lie within the
/// threshold, and between one and three thresholds there are no more than there would be of pairs
/// that belong to no model (as many a width as between three and five), plus a tenth of the
/// inliers. A model caught in a false minimum has its threshold in the midst of a slope.
[[nodiscard]] bool explains(const BearingColumns& columns, const Eigen::Matrix3d& E,
                            double threshold);

}  // namespace stillkite
