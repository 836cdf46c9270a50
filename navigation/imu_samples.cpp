#include "navigation/imu_samples.hpp"

#include <algorithm>

namespace stillkite {
namespace {

// A hole at an image's stamp that is due to rounding.
constexpr double kRounding_s = 1e-6;

}  // namespace

std::vector<ImuSample> imu_samples(const std::vector<InertialReading>& readings, Timestamp from,
                                   Timestamp to) {
  std::vector<ImuSample> samples;
  samples.reserve(readings.size() + 1);
  Timestamp at = from;
  const auto add = [&](const InertialReading& reading, Timestamp end, bool is_gap) {
    const double dt_s = seconds_between(at, end);
    if (dt_s > (is_gap ? kRounding_s : 0)) {
      samples.push_back({.dt_s = dt_s,
                         .angular_rate_rad_s = reading.angular_rate_in_body_rad_s,
                         .specific_force_m_s2 = reading.specific_force_in_body_m_s2,
                         .is_gap = is_gap});
    }
    at = std::max(at, end);
  };
  const InertialReading* last = nullptr;
  for (const InertialReading& reading : readings) {
    const bool is_finite = reading.angular_rate_in_body_rad_s.allFinite() &&
                           reading.specific_force_in_body_m_s2.allFinite();
    if (!is_finite || reading.stamp <= at || reading.stamp > to) continue;
    if (reading.valid_from) add(reading, std::min(*reading.valid_from, reading.stamp), true);
    add(reading, reading.stamp, false);
    last = &reading;
  }
  if (last != nullptr) add(*last, to, true);
  return samples;
}

}  // namespace stillkite
