#pragma once

#include <optional>
#include <string>

#include "io/import/imported_flight.hpp"
#include "io/import/imu_series.hpp"

namespace stillkite {

/// Violated property of an imported flight; nullopt if its readings are finite and in order.
[[nodiscard]] inline std::optional<std::string> problem_of(const ImportedFlight& flight) {
  const TimeSeries<Vector6d> imu = imu_series(flight);
  for (std::size_t i = 0; i < imu.stamps.size(); ++i) {
    if (!imu.values[i].allFinite()) return "a reading of the IMU is not finite";
    if (i > 0 && imu.stamps[i] <= imu.stamps[i - 1]) return "stamps of the IMU do not ascend";
  }
  for (const Eigen::Quaterniond& q : flight.attitude.values) {
    if (!q.coeffs().allFinite()) return "an attitude is not finite";
  }
  for (const GeodeticPosition& position : flight.positions.values) {
    if (!is_valid(position)) return "a position is out of range";
  }
  return std::nullopt;
}

}  // namespace stillkite
