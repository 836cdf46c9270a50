#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <variant>

#include "geometry/time.hpp"

namespace stillkite {

// Sensor readings in the body's axes (forward, left, up), on the local clock.

struct ImuSample {
  Timestamp stamp;
  Eigen::Vector3d angular_rate_in_body_rad_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d specific_force_in_body_m_s2 = Eigen::Vector3d::Zero();
};
struct AttitudeSample {
  Timestamp stamp;
  Eigen::Quaterniond world_from_body = Eigen::Quaterniond::Identity();  ///< world: z up
};
/// Distance along the body's -z of a range finder, or relative height of a barometer.
struct HeightSample {
  Timestamp stamp;
  double height_m = 0;
};
using SensorSample = std::variant<ImuSample, AttitudeSample, HeightSample>;

/// True and stored if the stamp is newer than the last one.
[[nodiscard]] inline bool is_newer(Timestamp stamp, std::optional<Timestamp>& last) {
  if (last && stamp <= *last) return false;
  last = stamp;
  return true;
}

}  // namespace stillkite
