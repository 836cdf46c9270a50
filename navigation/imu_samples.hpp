#pragma once

#include <vector>

#include "estimation/sliding_window/imu_preintegration.hpp"
#include "navigation/sensor_readings.hpp"

namespace stillkite {

/// Samples that cover (from, to] without a hole: intervals without a reading are gaps, with the
/// nearest reading. Readings that are not finite or not ascending are skipped. Empty without any.
[[nodiscard]] std::vector<ImuSample> imu_samples(const std::vector<InertialReading>& readings,
                                                 Timestamp from, Timestamp to);

}  // namespace stillkite
