#include "navigation/imu_intervals.hpp"

#include <algorithm>

namespace stillkite {

std::vector<ImuInterval> imu_intervals(const std::vector<InertialReading>& readings,
                                       Timestamp known_until) {
  std::vector<ImuInterval> out;
  out.reserve(readings.size());
  Timestamp at = known_until;
  for (const InertialReading& reading : readings) {
    const bool is_finite = reading.angular_rate_in_body_rad_s.allFinite() &&
                           reading.specific_force_in_body_m_s2.allFinite();
    if (!is_finite || reading.stamp <= at) continue;
    const Timestamp from = std::max(at, reading.valid_from.value_or(at));
    out.push_back({.from = from,
                   .to = reading.stamp,
                   .angular_rate_rad_s = reading.angular_rate_in_body_rad_s,
                   .specific_force_m_s2 = reading.specific_force_in_body_m_s2});
    at = reading.stamp;
  }
  return out;
}

}  // namespace stillkite
