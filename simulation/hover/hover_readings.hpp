#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "geometry/time.hpp"
#include "stabilization/tether.hpp"

namespace stillkite {

/// Known to the controller from `available` on; was true at `stamp`.
struct TetherSample {
  Timestamp stamp;
  Timestamp available;
  TetherState tether;  ///< in the station's frame; of a slack tether the length is no distance
  bool taut = true;    ///< as the reel feels it
};

struct AttitudeReading {
  Timestamp stamp;
  Eigen::Quaterniond world_from_body;  ///< its yaw drifts
  Eigen::Vector3d angular_rate_in_body_rad_s;
  Eigen::Vector3d specific_force_in_body_m_s2;
};

/// What the sensors measured at an instant; empty where none was due.
struct HoverReadings {
  std::vector<TetherSample> tether;
  std::vector<AttitudeReading> attitude;
};

}  // namespace stillkite
