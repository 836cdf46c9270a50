#pragma once

#include "estimation/plane/plane_alignment.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// A pose of the camera in the world and its error covariance (translation, rotation vector), both
/// in world axes: true rotation = exp(error) * rotation.
struct PoseEstimate {
  RigidTransform world_from_camera;
  Matrix6d covariance = Matrix6d::Zero();
};

struct LevellingConfig {
  bool enabled = true;
  double ground_slope_sigma_rad = 0.0005;
  double flow_sigma_rad = 1e-5;

  static void fields(auto& self, auto&& field) {
    field("enabled", self.enabled, "correct roll and pitch by the ground's normal");
    field("ground_slope_sigma_rad", self.ground_slope_sigma_rad, kNotNegative,
          "how far from level the ground under one image is, as a standard deviation");
    field("flow_sigma_rad", self.flow_sigma_rad, kNotNegative,
          "smooth error of the flow that no window can tell (lens, rolling shutter), as an angle");
  }
};

/// The alignment's guess: the motion from the keyframe to a predicted pose.
[[nodiscard]] PlaneMotion motion_between(const RigidTransform& world_from_keyframe,
                                         const RigidTransform& world_from_camera);

/// The normal is as uncertain as the keyframe's tilt, plus the slope of the ground.
[[nodiscard]] TiltPrior tilt_prior(const PoseEstimate& keyframe, const LevellingConfig& config);

/// What an alignment to a keyframe says of both poses.
struct ChainedPose {
  PoseEstimate keyframe;  ///< levelled by the plane's normal
  PoseEstimate camera;    ///< of the current frame, on the levelled keyframe
  RigidTransform keyframe_from_camera;
  Matrix6d relative_covariance;  ///< of `camera` against its keyframe alone, in world axes
  Matrix6d camera_by_twist;      ///< in world axes by the twist in the camera
};
[[nodiscard]] ChainedPose chain(const PoseEstimate& keyframe, const PlaneAlignment& alignment,
                                const LevellingConfig& config);

}  // namespace stillkite
