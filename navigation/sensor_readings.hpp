#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "estimation/verdict.hpp"
#include "geometry/rigid_transform.hpp"
#include "geometry/time.hpp"

namespace stillkite {

/// Body pose at the first frame.
struct InitialState {
  /// z: height above the ground, positive for every policy; 1 if unknown.
  RigidTransform world_from_body;
  /// Source of that height: `initial_height` if z is in metres; none: estimates are in initial
  /// heights and have no metric part.
  ScaleSource scale = ScaleSource::none;
};

/// Height of the body above the ground. A range finder measures along the body's -z: h = r
/// cos(tilt).
[[nodiscard]] inline double height_of_body_m(double reading_m, ScaleSource source,
                                             const Eigen::Quaterniond& world_from_body) {
  if (source != ScaleSource::range) return reading_m;
  return reading_m * (world_from_body * Eigen::Vector3d::UnitZ()).z();
}

/// IMU reading, valid from the previous reading's stamp to its own.
struct InertialReading {
  Timestamp stamp;
  Eigen::Vector3d angular_rate_in_body_rad_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d specific_force_in_body_m_s2 = Eigen::Vector3d::Zero();
  std::optional<Timestamp> valid_from = {};  ///< after a gap: later than the previous stamp
};

/// Readings of other sensors for the interval that ends at a frame; each is optional. Values that
/// are not finite are ignored.
struct SensorReadings {
  std::optional<Eigen::Vector3d> mean_angular_rate_in_body_rad_s;  ///< gyro, mean over the interval
  /// Height above the ground (a barometer's after its offset); for a range finder the distance
  /// along the body's -z.
  std::optional<double> height_m;
  ScaleSource height_source = ScaleSource::range;  ///< sensor of `height_m`
  std::optional<Eigen::Quaterniond> attitude;  ///< world_from_body; the flow uses roll and pitch
  /// a(t) of the flow paper, eq. (3): linear in the world (m/s^2), angular in the body (rad/s^2).
  /// Mode paper only.
  std::optional<Vector6d> acceleration;
  std::vector<InertialReading> inertial;  ///< of the interval, ascending; policy fused only
};

}  // namespace stillkite
