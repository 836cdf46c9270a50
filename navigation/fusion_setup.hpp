#pragma once

#include "estimation/fusion/fusion_state.hpp"
#include "navigation/navigator_config.hpp"
#include "navigation/sensor_readings.hpp"

// Configurations and initial values of the fused estimator's parts from the navigator's.

namespace stillkite {

/// Throws InputError where features cannot be followed, or too many landmarks are asked for.
[[nodiscard]] FusionConfig checked_fusion_config(const NavigatorConfig& navigator);

/// The camera, at any speed; without a height in a unit of which next to nothing is known.
[[nodiscard]] FusionStart fusion_start(const InitialState& initial,
                                       const RigidTransform& body_from_camera,
                                       double tilt_sigma_rad);

}  // namespace stillkite
