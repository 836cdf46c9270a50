#pragma once

#include <span>

#include "estimation/two_view/epipolar_error.hpp"
#include "estimation/two_view/relative_pose_config.hpp"

namespace stillkite {

/// Essential matrix with the lowest MSAC cost.
struct EssentialFit {
  RelativePose pose;  ///< one of the four poses of E, cheirality not tested
  double cost = 0;    ///< sum of min(e^2 / threshold^2, 1)
  int inliers = 0;    ///< pairs with |e| below the threshold
  bool found = false;
};

/// Locally optimized RANSAC with truncated squares (Chum, Matas and Kittler 2003; Torr and
/// Zisserman 2000, MSAC): each new best model is refined on all pairs. The `initial_poses` are
/// refined first; one that passes `is_supported` ends the search. `threshold` on z = 1. `found` is
/// false below five pairs or if no model has a lower cost than the empty one.
[[nodiscard]] EssentialFit fit_essential(const BearingColumns& columns, double threshold,
                                         const RelativePoseConfig& config,
                                         std::span<const RelativePose> initial_poses);

/// Refinement on all pairs of an initial pose with an error of up to a few degrees: with decreasing
/// cutoffs, or with the last cutoff alone if the cost is then lower.
[[nodiscard]] EssentialFit refine_initial_pose(const BearingColumns& columns,
                                               const RelativePose& initial, double threshold);

/// Acceptance test of a refined model. At least 25 % of the pairs are inliers. The number of pairs
/// between one and three thresholds is consistent with the outlier density between three and five,
/// plus 10 % of the inliers. A local minimum fails: its residuals have no gap at the threshold.
[[nodiscard]] bool is_supported(const BearingColumns& columns, const Eigen::Matrix3d& E,
                                double threshold);

}  // namespace stillkite
