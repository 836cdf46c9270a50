#pragma once

#include <vector>

#include "estimation/sliding_window/imu_timeline.hpp"
#include "navigation/sensor_readings.hpp"

namespace stillkite {

/// Readings after `known_until` with their intervals; those that are not finite or not ascending
/// are left out.
[[nodiscard]] std::vector<ImuInterval> imu_intervals(const std::vector<InertialReading>& readings,
                                                     Timestamp known_until);

}  // namespace stillkite
