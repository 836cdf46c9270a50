#pragma once

#include <Eigen/Geometry>

#include "estimation/two_view/epipolar_error.hpp"
#include "estimation/two_view/random_draws.hpp"

namespace stillkite {

/// The rotation b ~ R a that explains most pairs: RANSAC on two at a time, then `refine_rotation`.
/// `threshold` on z = 1.
[[nodiscard]] Eigen::Quaterniond fit_rotation(const BearingColumns& columns, double threshold,
                                              int draws, RandomDraws& random);

/// Gauss-Newton on the transfer errors of the homography R with Tukey's weights.
[[nodiscard]] Eigen::Quaterniond refine_rotation(const BearingColumns& columns,
                                                 Eigen::Quaterniond current_from_reference,
                                                 double cutoff, int steps);

/// As RelativePoseEstimate has it, the direction unknown: Huber's, as pose_covariance.
[[nodiscard]] Matrix6d rotation_covariance(const BearingColumns& columns,
                                           const Eigen::Quaterniond& current_from_reference,
                                           double cutoff);

/// The direction that the pairs within `cutoff` of the rotation are displaced along, up to its
/// sign: the eigenvector of sum m m^T with the least eigenvalue, m = b x R a.
[[nodiscard]] Eigen::Vector3d direction_beside(const BearingColumns& columns,
                                               const Eigen::Quaterniond& current_from_reference,
                                               double cutoff);

}  // namespace stillkite
