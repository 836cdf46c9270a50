#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "io/dataset/sensor_log.hpp"

// Whether a log can be one of this flight.

namespace stillkite {

/// Throws InputError where the specific forces are not those of a body that gravity pulls at: in
/// other units, without gravity, or along axes that are not the body's (x forward, y left, z up),
/// of which `world_from_body` tells where up is at the start.
void check_specific_forces(const TimeSeries<Vector6d>& imu, const std::string& key,
                           const Eigen::Quaterniond& world_from_body, Timestamp start);

/// A sentence for each log that has nothing, or not all, to say of the flight between two stamps.
[[nodiscard]] std::vector<std::string> uncovered_by_sensors(const SensorLog& log, Timestamp first,
                                                            Timestamp last);

}  // namespace stillkite
