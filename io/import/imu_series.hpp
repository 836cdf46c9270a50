#pragma once

#include "io/import/imported_flight.hpp"

namespace stillkite {

/// Angular rate and specific force at the stamps of the gyroscope; the specific force is
/// interpolated. Rates between accelerometer readings more than 0.2 s apart and above
/// 100 rad/s are left out.
[[nodiscard]] TimeSeries<Vector6d> imu_series(const ImportedFlight& flight);

}  // namespace stillkite
