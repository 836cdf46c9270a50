#pragma once

#include "geometry/rigid_transform.hpp"
#include "navigation/navigation_estimate.hpp"

namespace stillkite {

/// Camera motion since the initial camera pose. With a scale the displacement is metric, otherwise
/// of unknown kind and in initial heights.
[[nodiscard]] MotionEstimate motion_from_initial(const NavigationEstimate& estimate,
                                                 const RigidTransform& world_from_initial,
                                                 const RigidTransform& body_from_camera);

}  // namespace stillkite
