#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "geometry/time.hpp"
#include "stabilization/tether.hpp"

namespace stillkite {

/// Tether measurement with latency.
struct TetherSample {
  Timestamp stamp;      ///< time of measurement
  Timestamp available;  ///< time of arrival at the controller
  TetherState tether;   ///< station frame; the length of a slack tether exceeds the distance
  bool taut = true;     ///< measured by the reel
};

struct AttitudeReading {
  Timestamp stamp;
  Eigen::Quaterniond world_from_body;  ///< with yaw drift
  Eigen::Vector3d angular_rate_in_body_rad_s;
  Eigen::Vector3d specific_force_in_body_m_s2;
};

/// Sensor readings of one instant; empty if none is due.
struct HoverReadings {
  std::vector<TetherSample> tether;
  std::vector<AttitudeReading> attitude;
};

}  // namespace stillkite
