#pragma once

#include <cmath>

#include "bench/hover_views.hpp"
#include "navigation/sensor_readings.hpp"
#include "simulation/flight/sensors.hpp"

namespace stillkite::bench {

/// Simulated IMU of the hover trials. World: body frame at the initial pose.
class HoverImu {
 public:
  HoverImu(const Hover& hover, std::uint64_t seed) : hover_(hover), errors_(config_, seed) {}

  /// Readings since the last call up to `t_s`, with the attitude at `t_s`.
  SensorReadings read_until(double t_s) {
    constexpr double kRounding_s = 1e-9;
    SensorReadings readings;
    readings.attitude = world_from_body(t_s).rotation;
    const auto end = static_cast<int>(std::floor((t_s + kRounding_s) * config_.rate_hz));
    while (count_ < end) readings.inertial.push_back(read(++count_ / config_.rate_hz));
    return readings;
  }

 private:
  [[nodiscard]] RigidTransform world_from_body(double t_s) const {
    return hover_.world_from_initial.inverse() * hover_.world_from_body(t_s);
  }
  // numerical differentiation of the pose
  InertialReading read(double t_s) {
    constexpr double kStep_s = 1e-3;
    const RigidTransform previous = world_from_body(t_s - kStep_s);
    const RigidTransform now = world_from_body(t_s);
    const RigidTransform next = world_from_body(t_s + kStep_s);
    const Eigen::Vector3d acceleration_m_s2 =
        (previous.translation - 2 * now.translation + next.translation) / (kStep_s * kStep_s);
    const ImuReading raw = errors_.add_to(
        {.stamp = from_seconds(t_s),
         .angular_rate_in_body_rad_s =
             so3_log(previous.rotation.conjugate() * next.rotation) / (2 * kStep_s),
         .specific_force_in_body_m_s2 =
             now.rotation.conjugate() * (acceleration_m_s2 - gravity_in_world_m_s2())});
    return {raw.stamp, raw.angular_rate_in_body_rad_s, raw.specific_force_in_body_m_s2};
  }

  Hover hover_;
  ImuConfig config_;
  ImuErrors errors_;
  int count_ = 0;
};

}  // namespace stillkite::bench
