#include "io/dataset/sensor_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "geometry/fields.hpp"
#include "geometry/gravity.hpp"

namespace stillkite {
namespace {

// What is missing of it, if anything.
template <typename Value>
std::optional<std::string> uncovered(const TimeSeries<Value>& series, const char* name,
                                     Timestamp first, Timestamp last) {
  constexpr double kMost = 0.1;  // of the flight
  if (series.stamps.empty()) return std::nullopt;
  const Timestamp from = std::max(first, series.stamps.front());
  const Timestamp to = std::min(last, series.stamps.back());
  const double flight_s = seconds_between(first, last);
  const double covered_s = std::max(0.0, seconds_between(from, to));
  if (from <= to && covered_s >= (1 - kMost) * flight_s) return std::nullopt;
  const std::string spans =
      fmt::format("from {:.3f} s to {:.3f} s, the images are from {:.3f} s to {:.3f} s",
                  to_seconds(series.stamps.front()), to_seconds(series.stamps.back()),
                  to_seconds(first), to_seconds(last));
  if (from > to) {
    return fmt::format("{}: no reading was used: they are {}: are both on one clock?", name, spans);
  }
  return fmt::format("{}: covers {:.1f} of {:.1f} s: its readings are {}", name, covered_s,
                     flight_s, spans);
}

}  // namespace

void check_specific_forces(const TimeSeries<Vector6d>& imu, const std::string& key,
                           const Eigen::Quaterniond& world_from_body, Timestamp start) {
  constexpr double kStart_s = 1;
  constexpr double kLeast_m_s2 = kGravity_m_s2 / 3, kMost_m_s2 = 3 * kGravity_m_s2;
  double sum_m_s2 = 0;
  Eigen::Vector3d at_start = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < imu.stamps.size(); ++i) {
    const Eigen::Vector3d force = imu.values[i].tail<3>();
    sum_m_s2 += force.norm();
    if (std::abs(seconds_between(start, imu.stamps[i])) < kStart_s) at_start += force;
  }
  const double mean_m_s2 = sum_m_s2 / static_cast<double>(imu.stamps.size());
  if (mean_m_s2 < kLeast_m_s2 || mean_m_s2 > kMost_m_s2) {
    throw InputError(fmt::format(
        "{}: the specific force is {:.3g} m/s^2 in the mean, a body that is held up has {}: is it "
        "in another unit, or was gravity taken away?",
        key, mean_m_s2, kGravity_m_s2));
  }
  const Eigen::Vector3d up = world_from_body.conjugate() * Eigen::Vector3d::UnitZ();
  if (at_start.dot(up) < 0) {
    const Eigen::Vector3d along = at_start.normalized();
    throw InputError(fmt::format(
        "{}: at the start the specific force is along ({:.2f}, {:.2f}, {:.2f}) of the body, up is "
        "({:.2f}, {:.2f}, {:.2f}): the body's axes are x forward, y left, z up "
        "(its attitude at the start: initial.roll_deg, pitch_deg)",
        key, along.x(), along.y(), along.z(), up.x(), up.y(), up.z()));
  }
}

std::vector<std::string> uncovered_by_sensors(const SensorLog& log, Timestamp first,
                                              Timestamp last) {
  const std::optional<std::string> each[] = {
      uncovered(log.imu, "imu.path", first, last),
      log.imu.stamps.empty() ? uncovered(log.angular_rate_in_body_rad_s, "gyro.path", first, last)
                             : std::nullopt,
      uncovered(log.height_m, "height.path", first, last),
      uncovered(log.attitude, "attitude.path", first, last),
      uncovered(log.acceleration, "acceleration.path", first, last)};
  std::vector<std::string> sentences;
  for (const std::optional<std::string>& one : each) {
    if (one) sentences.push_back(*one);
  }
  return sentences;
}

}  // namespace stillkite
