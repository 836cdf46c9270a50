#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "estimation/verdict.hpp"
#include "geometry/rigid_transform.hpp"
#include "geometry/time.hpp"

namespace stillkite {

/// Where the flight starts. Without a height the answers are in heights (see NavigationEstimate).
struct InitialState {
  RigidTransform world_from_body;         ///< z is the body's height over the ground
  ScaleSource scale = ScaleSource::none;  ///< what gave that height
};

/// Height over the ground of a body: a range finder looks along its -z, whatever the tilt.
[[nodiscard]] inline double height_of_body_m(double reading_m, ScaleSource source,
                                             const Eigen::Quaterniond& world_from_body) {
  if (source != ScaleSource::range) return reading_m;
  return reading_m * (world_from_body * Eigen::Vector3d::UnitZ()).z();
}

/// Of an IMU; each holds for the time since the one before.
struct InertialReading {
  Timestamp stamp;
  Eigen::Vector3d angular_rate_in_body_rad_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d specific_force_in_body_m_s2 = Eigen::Vector3d::Zero();
};

/// Readings of other sensors for the interval that ends at a frame; each is optional.
struct SensorReadings {
  std::optional<Eigen::Vector3d> mean_angular_rate_in_body_rad_s;  ///< gyro, mean since last frame
  std::optional<double> height_m;  ///< of the body over the ground; a range: along the body's -z
  ScaleSource height_source = ScaleSource::range;  ///< what measured that height
  std::optional<Eigen::Quaterniond> attitude;      ///< world_from_body
  std::optional<Vector6d> acceleration;   ///< a(t) of the flow paper, eq. (3): linear in the world
                                          ///< (m/s^2), then angular in the body (rad/s^2)
  std::vector<InertialReading> inertial;  ///< since the frame before, ascending
};

}  // namespace stillkite
