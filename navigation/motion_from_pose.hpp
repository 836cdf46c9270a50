#pragma once

#include "estimation/motion_estimate.hpp"
#include "estimation/two_view/relative_pose.hpp"

namespace stillkite {

/// The camera as the reference sees it, by a pose of the reference as the camera sees it; status
/// ok, without stamp and speed.
[[nodiscard]] MotionEstimate motion_from_pose(const RelativePoseEstimate& pose);

/// The inverse: displacement as it is, no covariance.
[[nodiscard]] RelativePose pose_from_motion(const MotionEstimate& motion);

}  // namespace stillkite
