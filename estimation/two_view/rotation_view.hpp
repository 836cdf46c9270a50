#pragma once

#include <Eigen/Geometry>

#include "estimation/two_view/epipolar_error.hpp"
#include "estimation/two_view/random_draws.hpp"

namespace stillkite {

/// Rotation b ~ R a by RANSAC on samples of two pairs, then `refine_rotation`. `threshold` on
/// z = 1.
[[nodiscard]] Eigen::Quaterniond fit_rotation(const BearingColumns& columns, double threshold,
                                              int draws, RandomDraws& random);

/// Gauss-Newton on the transfer errors of the homography R with Tukey weights.
[[nodiscard]] Eigen::Quaterniond refine_rotation(const BearingColumns& columns,
                                                 Eigen::Quaterniond current_from_reference,
                                                 double cutoff, int steps);

/// Covariance of the rotation in the upper block, ordered as in RelativePoseEstimate; the direction
/// block is 0. Huber's estimator as in `pose_covariance`; 0 if the rotation is not observable.
[[nodiscard]] Matrix6d rotation_covariance(const BearingColumns& columns,
                                           const Eigen::Quaterniond& current_from_reference,
                                           double cutoff);

/// Translation direction for a given rotation, sign ambiguous: eigenvector of sum m m^T with the
/// smallest eigenvalue, m = b x R a, over pairs with a transfer error below `cutoff`.
[[nodiscard]] Eigen::Vector3d displacement_direction(
    const BearingColumns& columns, const Eigen::Quaterniond& current_from_reference, double cutoff);

}  // namespace stillkite
