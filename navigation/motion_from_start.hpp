#pragma once

#include "geometry/rigid_transform.hpp"
#include "navigation/navigation_estimate.hpp"

namespace stillkite {

/// An estimate's own pose, seen from the camera at the start; its displacement is metric where it
/// has a scale, else of unknown kind and in start heights.
[[nodiscard]] MotionEstimate motion_from_start(const NavigationEstimate& estimate,
                                               const RigidTransform& world_from_start,
                                               const RigidTransform& body_from_camera);

}  // namespace stillkite
