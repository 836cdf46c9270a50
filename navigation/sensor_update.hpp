#pragma once

#include <optional>

#include "estimation/plane/keyframe_pose.hpp"
#include "geometry/time.hpp"
#include "navigation/navigator_config.hpp"
#include "navigation/sensor_readings.hpp"

namespace stillkite {

/// Camera pose with the source of its scale.
struct ScaledPose {
  PoseEstimate pose;
  ScaleSource scale = ScaleSource::none;
  Timestamp scale_stamp;          ///< of the last reading used for the scale
  int rejected_heights = 0;       ///< consecutive distinct outliers
  double rejected_reading_m = 0;  ///< last rejected reading, as measured
};

/// Sensor readings converted from the body to the camera.
struct CameraReadings {
  std::optional<double> height_m;  ///< of the camera above the ground
  double reading_m = 0;            ///< height or range as measured
  ScaleSource height_source = ScaleSource::range;
  std::optional<Eigen::Quaterniond> attitude;  ///< world_from_camera
};

/// `world_from_camera`: attitude at which tilt and lever arm are compensated.
[[nodiscard]] CameraReadings camera_readings(const SensorReadings& readings,
                                             const RigidTransform& body_from_camera,
                                             const Eigen::Quaterniond& world_from_camera);

/// Kalman update of a pose by height and by the attitude's roll and pitch; its yaw drifts and is
/// not used. Without a scale the first height rescales the world. A height outlier is rejected
/// until five consecutive, distinct readings are outliers: a range finder without an echo repeats
/// its maximum range.
[[nodiscard]] ScaledPose apply_readings(const ScaledPose& before, const CameraReadings& readings,
                                        const SensorConfig& config, Timestamp now);

/// Covariance of a pose reached from `before` by visual motion: J P J^T. A height error scales the
/// translation, an attitude error rotates it.
[[nodiscard]] Matrix6d propagated_covariance(const PoseEstimate& before,
                                             const RigidTransform& after);

}  // namespace stillkite
