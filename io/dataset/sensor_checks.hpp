#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "io/dataset/sensor_log.hpp"

// Plausibility checks of sensor logs.

namespace stillkite {

/// Magnitude of the mean specific force of each second of the log, not empty: vibration cancels in
/// each mean.
[[nodiscard]] std::vector<double> mean_force_magnitudes_m_s2(const TimeSeries<Vector6d>& imu);

/// Unit of a specific force; m/s^2 = factor x value.
struct ForceUnit {
  const char* name;
  double factor;
};

/// Unit in which a mean specific force is gravity within 25 %; nullopt without one.
[[nodiscard]] std::optional<ForceUnit> probable_force_unit(double mean_m_s2);

/// Throws InputError if the mean specific force of a second is not within a factor of 3 of gravity
/// (wrong unit, gravity removed), or if it points down in the body frame (x forward, y left, z up)
/// within 1 s of `start`, given the initial attitude.
void check_specific_forces(const TimeSeries<Vector6d>& imu, const std::string& key,
                           const Eigen::Quaterniond& world_from_body, Timestamp start);

/// Throws InputError if the rotation of the specific force agrees with the angular rates only if
/// these are in deg/s.
void check_rate_unit(const TimeSeries<Vector6d>& imu, const std::string& key);

/// One message for each log that covers less than 90 % of the flight between two stamps, has gaps
/// in it, or, of an IMU or gyroscope, fewer than 50 readings per second.
[[nodiscard]] std::vector<std::string> coverage_warnings(const SensorLog& log, Timestamp first,
                                                         Timestamp last);

}  // namespace stillkite
