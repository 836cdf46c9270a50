#include "io/dataset/sensor_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "geometry/fields.hpp"
#include "geometry/gravity.hpp"

namespace stillkite {
namespace {

// Nullopt if the series is empty or covers the flight.
template <typename Value>
std::optional<std::string> coverage_warning(const TimeSeries<Value>& series, const char* name,
                                            Timestamp first, Timestamp last) {
  constexpr double kMaxUncoveredRatio = 0.1;  // of the flight
  if (series.stamps.empty()) return std::nullopt;
  const Timestamp from = std::max(first, series.stamps.front());
  const Timestamp to = std::min(last, series.stamps.back());
  const double flight_s = seconds_between(first, last);
  const double covered_s = std::max(0.0, seconds_between(from, to));
  if (from <= to && covered_s >= (1 - kMaxUncoveredRatio) * flight_s) return std::nullopt;
  const std::string spans = fmt::format(
      "{:.3f} s to {:.3f} s, images from {:.3f} s to {:.3f} s", to_seconds(series.stamps.front()),
      to_seconds(series.stamps.back()), to_seconds(first), to_seconds(last));
  if (from > to) {
    return fmt::format("{}: no reading within the flight: readings from {}; use one clock for both",
                       name, spans);
  }
  return fmt::format("{}: covers {:.1f} s of {:.1f} s: readings from {}", name, covered_s, flight_s,
                     spans);
}

}  // namespace

void check_specific_forces(const TimeSeries<Vector6d>& imu, const std::string& key,
                           const Eigen::Quaterniond& world_from_body, Timestamp start) {
  constexpr double kInitialInterval_s = 1;
  constexpr double kMinForce_m_s2 = kGravity_m_s2 / 3, kMaxForce_m_s2 = 3 * kGravity_m_s2;
  double sum_m_s2 = 0;
  Eigen::Vector3d initial_sum_m_s2 = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < imu.stamps.size(); ++i) {
    const Eigen::Vector3d force = imu.values[i].tail<3>();
    sum_m_s2 += force.norm();
    if (std::abs(seconds_between(start, imu.stamps[i])) < kInitialInterval_s)
      initial_sum_m_s2 += force;
  }
  const double mean_m_s2 = sum_m_s2 / static_cast<double>(imu.stamps.size());
  if (mean_m_s2 < kMinForce_m_s2 || mean_m_s2 > kMaxForce_m_s2) {
    throw InputError(
        fmt::format("{}: the mean specific force is {:.3g} m/s^2, expected about {} (gravity); "
                    "give it in m/s^2, "
                    "gravity included",
                    key, mean_m_s2, kGravity_m_s2));
  }
  const Eigen::Vector3d up = world_from_body.conjugate() * Eigen::Vector3d::UnitZ();
  if (initial_sum_m_s2.dot(up) < 0) {
    const Eigen::Vector3d direction = initial_sum_m_s2.normalized();
    throw InputError(fmt::format(
        "{}: the initial specific force points along ({:.2f}, {:.2f}, {:.2f}) in the body, up is "
        "({:.2f}, {:.2f}, {:.2f}); check the body axes (x forward, y left, z up) and the initial "
        "attitude (initial.roll_deg, initial.pitch_deg)",
        key, direction.x(), direction.y(), direction.z(), up.x(), up.y(), up.z()));
  }
}

std::vector<std::string> coverage_warnings(const SensorLog& log, Timestamp first, Timestamp last) {
  const std::optional<std::string> warnings[] = {
      coverage_warning(log.imu, "imu.path", first, last),
      log.imu.stamps.empty()
          ? coverage_warning(log.angular_rate_in_body_rad_s, "gyro.path", first, last)
          : std::nullopt,
      coverage_warning(log.height_m, "height.path", first, last),
      coverage_warning(log.attitude, "attitude.path", first, last),
      coverage_warning(log.acceleration, "acceleration.path", first, last)};
  std::vector<std::string> found;
  for (const std::optional<std::string>& warning : warnings) {
    if (warning) found.push_back(*warning);
  }
  return found;
}

}  // namespace stillkite
