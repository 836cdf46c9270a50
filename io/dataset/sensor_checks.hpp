#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "io/dataset/sensor_log.hpp"

// Plausibility checks of sensor logs.

namespace stillkite {

/// Throws InputError if the mean specific force is not within a factor of 3 of gravity (wrong unit,
/// gravity removed), or if it points down in the body frame (x forward, y left, z up) within 1 s of
/// `start`, given the initial attitude.
void check_specific_forces(const TimeSeries<Vector6d>& imu, const std::string& key,
                           const Eigen::Quaterniond& world_from_body, Timestamp start);

/// One message for each log that covers less than 90 % of the flight between two stamps.
[[nodiscard]] std::vector<std::string> coverage_warnings(const SensorLog& log, Timestamp first,
                                                         Timestamp last);

}  // namespace stillkite
