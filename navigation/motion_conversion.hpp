#pragma once

#include "estimation/motion_estimate.hpp"
#include "estimation/two_view/relative_pose.hpp"
#include "geometry/rigid_transform.hpp"
#include "navigation/navigation_estimate.hpp"

namespace stillkite {

/// Camera pose in the reference frame (R^T, -R^T t) from the two-view pose (R, t); status ok.
/// Stamp and twist are not set.
[[nodiscard]] MotionEstimate motion_from_pose(const RelativePoseEstimate& pose);

/// Inverse of `motion_from_pose`, without covariance; the displacement keeps its scale.
[[nodiscard]] RelativePose pose_from_motion(const MotionEstimate& motion);

/// Camera motion since the initial camera pose. With a scale the displacement is metric, otherwise
/// of unknown kind and in initial heights.
[[nodiscard]] MotionEstimate motion_from_initial(const NavigationEstimate& estimate,
                                                 const RigidTransform& world_from_initial,
                                                 const RigidTransform& body_from_camera);

/// Motion relative to the reference pose, for the controller; status per policy:
/// docs/hold_control.md.
/// - Reference, or fusion without a scale: motion since the reference frame. After a reference
///   change the attitude is chained to the first one.
/// - Flow, or fusion with a scale: motion since the first frame, metric if there is a scale.
/// `initial_covariance`: pose covariance of the first frame's estimate.
[[nodiscard]] MotionEstimate motion_estimate(const NavigationEstimate& estimate,
                                             const Matrix6d& initial_covariance,
                                             const RigidTransform& body_from_camera);

}  // namespace stillkite
