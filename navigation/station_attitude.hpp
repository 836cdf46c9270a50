#pragma once

#include <Eigen/Geometry>
#include <optional>

namespace stillkite {

/// Attitude of the body in the station's frame if the heading between the two is unknown: the
/// initial yaw is 0. Without readings of an attitude sensor, the visual rotation is integrated.
class StationAttitude {
 public:
  /// station_from_body from the visual estimate and, if available, a sensor's attitude.
  Eigen::Quaterniond step(const Eigen::Quaterniond& estimated_world_from_body,
                          const std::optional<Eigen::Quaterniond>& measured_world_from_body);

 private:
  std::optional<Eigen::Quaterniond> station_from_body_;
  Eigen::Quaterniond estimated_world_from_body_ = Eigen::Quaterniond::Identity();
  std::optional<Eigen::Quaterniond> station_from_sensor_world_;
};

}  // namespace stillkite
