#pragma once

#include <Eigen/Core>
#include <array>

#include "estimation/ego_motion/plane_motion.hpp"
#include "estimation/two_view/epipolar_error.hpp"
#include "estimation/two_view/random_draws.hpp"

namespace stillkite {

/// Two plane-induced motions of a homography, with normals n_z > 0. Both are equal for a pure
/// rotation or a translation along the normal. `scaled_homography`: H times any factor except 0.
/// Ma, Soatto, Kosecka and Sastry 2004, "An invitation to 3-D vision", theorem 5.19.
[[nodiscard]] std::array<PlaneMotion, 2> decompose_homography(
    const Eigen::Matrix3d& scaled_homography);

/// Homography by RANSAC on samples of four pairs, at most `draws`, then `refine_homography`.
/// `threshold` on z = 1.
[[nodiscard]] Eigen::Matrix3d fit_homography(const BearingColumns& columns, double threshold,
                                             int draws, RandomDraws& random);

/// Gauss-Newton on the transfer errors with Tukey weights, over the entries of H orthogonal to H
/// (the scale of H is a gauge); `cutoff` on z = 1.
[[nodiscard]] Eigen::Matrix3d refine_homography(const BearingColumns& columns, Eigen::Matrix3d H,
                                                double cutoff, int steps);

/// Covariance (rotation, direction) of the motion of a refined homography, ordered as in
/// RelativePoseEstimate. Huber's estimator as in `pose_covariance`; 0 if the motion is not
/// observable.
[[nodiscard]] Matrix6d plane_covariance(const BearingColumns& columns, const PlaneMotion& motion,
                                        double cutoff);

}  // namespace stillkite
