#include "navigation/fusion_setup.hpp"

#include <fmt/format.h>

#include "navigation/assumptions.hpp"

namespace stillkite {

FusionConfig checked_fusion_config(const NavigatorConfig& navigator) {
  const FusionConfig& config = navigator.fusion;
  if (navigator.reference.association == Association::matching) {
    throw InputError(
        "reference.association: matching numbers features anew in every frame; the fusion follows "
        "them");
  }
  if (config.min_landmarks <= config.landmarks) return config;
  throw InputError(fmt::format("fusion.min_landmarks: {} is more than fusion.landmarks, {}",
                               config.min_landmarks, config.landmarks));
}

FusionStart fusion_start(const InitialState& initial, const RigidTransform& body_from_camera,
                         double tilt_sigma_rad) {
  constexpr double kAnyHeight_log = 1.5;  // a factor of 4.5
  const RigidTransform world_from_camera = initial.world_from_body * body_from_camera;
  return {.world_from_camera = world_from_camera,
          .velocity_sigma = kInitialSpeedSigma_heights_s * world_from_camera.translation.z(),
          .tilt_sigma_rad = tilt_sigma_rad,
          .log_unit_sigma = initial.scale == ScaleSource::none ? kAnyHeight_log : 0};
}

}  // namespace stillkite
