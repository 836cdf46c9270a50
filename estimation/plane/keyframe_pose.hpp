#pragma once

#include "estimation/plane/levelling_config.hpp"
#include "estimation/plane/plane_alignment.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// Camera pose in world with its error covariance (translation, rotation vector), both in world
/// axes: true rotation = exp(error) * rotation.
struct PoseEstimate {
  RigidTransform world_from_camera;
  Matrix6d covariance = Matrix6d::Zero();
};

/// Plane motion from the keyframe to a camera pose; initial value of the alignment.
[[nodiscard]] PlaneMotion motion_between(const RigidTransform& world_from_keyframe,
                                         const RigidTransform& world_from_camera);

/// Prior of the plane normal: covariance of the keyframe tilt plus that of the ground slope.
[[nodiscard]] TiltPrior tilt_prior(const PoseEstimate& keyframe, const LevellingConfig& config);

/// Poses of keyframe and camera after an alignment.
struct ChainedPose {
  PoseEstimate keyframe;  ///< tilt corrected by the plane normal
  PoseEstimate camera;    ///< current frame, relative to the corrected keyframe
  RigidTransform keyframe_from_camera;
  Matrix6d relative_covariance;  ///< of the motion from keyframe to `camera`, in world axes: errors
                                 ///< that are independent from frame to frame
  Matrix6d common_covariance;    ///< the same: errors common to the frames of a keyframe (tilt,
                                 ///< lens, relief), which grow with the motion
  Matrix6d camera_by_twist;      ///< d(camera pose error in world)/d(twist in camera)
};

/// Camera pose from the keyframe pose and the alignment. The height of the keyframe sets the metric
/// scale.
[[nodiscard]] ChainedPose chain(const PoseEstimate& keyframe, const PlaneAlignment& alignment,
                                const LevellingConfig& config);

}  // namespace stillkite
