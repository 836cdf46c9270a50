#include "navigation/inertial_steps.hpp"

#include <algorithm>

namespace stillkite {
namespace {

InertialStep in_camera(const InertialReading& reading, double dt_s,
                       const Eigen::Quaterniond& body_from_camera) {
  const Eigen::Quaterniond camera_from_body = body_from_camera.conjugate();
  return {.dt_s = dt_s,
          .angular_rate_rad_s = camera_from_body * reading.angular_rate_in_body_rad_s,
          .is_gyro = true,
          .specific_force_m_s2 = camera_from_body * reading.specific_force_in_body_m_s2};
}

}  // namespace

std::vector<InertialStep> inertial_steps(const std::vector<InertialReading>& readings,
                                         Timestamp from, Timestamp to,
                                         const Eigen::Quaterniond& body_from_camera) {
  constexpr double kMaxHold_s = 0.02;
  std::vector<InertialStep> steps;
  steps.reserve(readings.size());
  Timestamp at = from;
  for (const InertialReading& reading : readings) {
    const bool is_finite = reading.angular_rate_in_body_rad_s.allFinite() &&
                           reading.specific_force_in_body_m_s2.allFinite();
    if (!is_finite || reading.stamp <= at || reading.stamp > to) continue;
    const Timestamp start = std::max(at, reading.valid_from.value_or(at));
    const double dt_s = seconds_between(start, reading.stamp);
    if (dt_s > 0) steps.push_back(in_camera(reading, dt_s, body_from_camera));
    at = reading.stamp;
  }
  const double remaining_s = seconds_between(at, to);
  if (!steps.empty() && remaining_s <= kMaxHold_s) steps.back().dt_s += remaining_s;
  return steps;
}

}  // namespace stillkite
