#pragma once

#include <Eigen/Core>

#include "estimation/two_view/epipolar_error.hpp"
#include "estimation/two_view/relative_pose.hpp"

namespace stillkite {

/// Tukey cutoff in standard deviations for 95 % efficiency on normal noise.
inline constexpr double kTukeyCutoff = 4.685;

/// Orthonormal basis of the plane normal to a unit vector.
[[nodiscard]] Eigen::Matrix<double, 3, 2> tangent_basis(const Eigen::Vector3d& direction);

/// Pose after a step (w, u): exp(w) R and normalized t + B u, B the tangent basis of t.
using PoseStep = Eigen::Matrix<double, 5, 1>;
[[nodiscard]] RelativePose apply(const RelativePose& pose, const PoseStep& step);

/// d vec(E) / d(w, u) of a PoseStep at 0, E row by row.
[[nodiscard]] Eigen::Matrix<double, 9, 5> essential_jacobian(const RelativePose& pose);

/// Gauss-Newton on the Sampson errors with Tukey weights over rotation and direction: at most
/// `steps`, ending below a step of 1e-7. Returns the pose before a singular step.
[[nodiscard]] RelativePose refine_pose(const BearingColumns& columns, RelativePose pose,
                                       double cutoff, int steps);

/// Covariance (rotation, direction) of a refined pose, ordered as in RelativePoseEstimate: Huber's
/// for robust least squares, times `cluster_variance_ratio` (docs/two_view_pose.md). 0 if the pose
/// is not observable.
[[nodiscard]] Matrix6d pose_covariance(const BearingColumns& columns, const RelativePose& pose,
                                       double cutoff);

}  // namespace stillkite
