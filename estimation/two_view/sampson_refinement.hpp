#pragma once

#include <Eigen/Core>

#include "estimation/two_view/epipolar_error.hpp"
#include "estimation/two_view/relative_pose.hpp"

namespace stillkite {

/// The cutoff of Tukey's weights, in standard deviations, that keeps 95 % of the efficiency on
/// normal noise.
inline constexpr double kTukeyCutoff = 4.685;

/// Two unit vectors that span the plane normal to a unit vector.
[[nodiscard]] Eigen::Matrix<double, 3, 2> tangent_basis(const Eigen::Vector3d& direction);

/// The pose after a step (w, u): exp(w) R, and t turned towards B u, B its tangent basis.
using PoseStep = Eigen::Matrix<double, 5, 1>;
[[nodiscard]] RelativePose apply(const RelativePose& pose, const PoseStep& step);

/// d vec(E) / d(w, u) of that step at 0, E row by row.
[[nodiscard]] Eigen::Matrix<double, 9, 5> essential_jacobian(const RelativePose& pose);

/// Gauss-Newton on the Sampson errors over rotation and direction with Tukey's weights, from a pose
/// that is near: at most so many steps, fewer once they are below 1e-7. Where a step is singular
/// the pose stays as it is.
[[nodiscard]] RelativePose refine_pose(const BearingColumns& columns, RelativePose pose,
                                       double cutoff, int steps);

/// Of a refined pose, over (rotation, direction) as in RelativePoseEstimate: Huber's for robust
/// least squares, times what neighbours err by alike (docs/reference_pose.md, "Sampson error,
/// weights, covariance"). Zero where the pairs do not tell the pose.
[[nodiscard]] Matrix6d pose_covariance(const BearingColumns& columns, const RelativePose& pose,
                                       double cutoff);

}  // namespace stillkite
