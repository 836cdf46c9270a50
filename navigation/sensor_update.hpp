#pragma once

#include <optional>

#include "estimation/plane/keyframe_pose.hpp"
#include "geometry/time.hpp"
#include "navigation/navigator_config.hpp"
#include "navigation/sensor_readings.hpp"

namespace stillkite {

/// A pose of the camera, and what last told its metres.
struct ScaledPose {
  PoseEstimate pose;
  ScaleSource scale = ScaleSource::none;
  Timestamp scale_stamp;
  int refused_heights = 0;  ///< in a row
  double refused_m = 0;     ///< the last of them, as it was told
};

/// What other sensors say of the camera itself.
struct CameraReadings {
  std::optional<double> height_m;  ///< over the ground
  double told_m = 0;               ///< the reading that it comes from
  ScaleSource height_source = ScaleSource::range;
  std::optional<Eigen::Quaterniond> attitude;  ///< world_from_camera
};

/// Readings are of the body; where the camera sits in it is seen at the attitude world_from_camera.
[[nodiscard]] CameraReadings of_camera(const SensorReadings& readings,
                                       const RigidTransform& body_from_camera,
                                       const Eigen::Quaterniond& world_from_camera);

/// Kalman update of a pose by height and attitude, of which roll and pitch count: the yaw of an
/// inertial sensor drifts as ours does. The first height in a flight without scale sets it: the
/// world is stretched. A height that is far from what is known is left out, unless five in a row
/// are that change: a range finder that sees nothing tells its longest range again and again.
[[nodiscard]] ScaledPose with_readings(const ScaledPose& before, const CameraReadings& readings,
                                       const SensorConfig& config, Timestamp now);

/// What `before`'s errors make of a pose that was reached from it by visual motion: an error of the
/// height is one of the way's length, an error of attitude bends the way.
[[nodiscard]] Matrix6d carried_covariance(const PoseEstimate& before, const RigidTransform& after);

}  // namespace stillkite
