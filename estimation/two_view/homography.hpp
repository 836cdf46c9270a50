#pragma once

#include <Eigen/Core>
#include <array>

#include "estimation/ego_motion/plane_motion.hpp"
#include "estimation/two_view/epipolar_error.hpp"
#include "estimation/two_view/random_draws.hpp"

namespace stillkite {

/// The two motions over a plane that share a homography, each with its normal such that n^T (0, 0,
/// 1) > 0; equal where nothing but a rotation, or a translation along the normal, is seen.
/// `any_scale`: H times any number but 0. Ma, Soatto, Kosecka and Sastry 2004, "An invitation to
/// 3-D vision", theorem 5.19.
[[nodiscard]] std::array<PlaneMotion, 2> decompose_homography(const Eigen::Matrix3d& any_scale);

/// The homography that explains most pairs: RANSAC on four at a time, at most `draws`, then
/// `refine_homography`. `threshold` on z = 1.
[[nodiscard]] Eigen::Matrix3d fit_homography(const BearingColumns& columns, double threshold,
                                             int draws, RandomDraws& random);

/// Gauss-Newton on the transfer errors over the entries of H across H itself, whose scale is free,
/// with Tukey's weights; `cutoff` on z = 1.
[[nodiscard]] Eigen::Matrix3d refine_homography(const BearingColumns& columns, Eigen::Matrix3d H,
                                                double cutoff, int steps);

/// As RelativePoseEstimate has it, of the view of a refined homography: Huber's, as
/// pose_covariance; zero where the pairs do not tell the view.
[[nodiscard]] Matrix6d plane_covariance(const BearingColumns& columns, const PlaneMotion& view,
                                        double cutoff);

}  // namespace stillkite
