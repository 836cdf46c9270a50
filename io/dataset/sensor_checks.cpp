#include "io/dataset/sensor_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include "geometry/angle.hpp"
#include "geometry/fields.hpp"
#include "geometry/gravity.hpp"
#include "geometry/median.hpp"
#include "io/dataset/interpolation_noise.hpp"

namespace stillkite {
namespace {

// Mean force and integrated rate of an interval of 0.2 s.
struct IntervalMean {
  Eigen::Vector3d force_m_s2 = Eigen::Vector3d::Zero();
  Eigen::Vector3d rotation_rad = Eigen::Vector3d::Zero();
};

std::vector<IntervalMean> interval_means(const TimeSeries<Vector6d>& imu) {
  constexpr double kInterval_s = 0.2;
  std::vector<IntervalMean> out;
  IntervalMean sum;
  std::size_t begin = 0;
  for (std::size_t i = 1; i < imu.stamps.size(); ++i) {
    const double dt_s = seconds_between(imu.stamps[i - 1], imu.stamps[i]);
    sum.force_m_s2 += imu.values[i].tail<3>();
    sum.rotation_rad += dt_s * imu.values[i].head<3>();
    if (seconds_between(imu.stamps[begin], imu.stamps[i]) < kInterval_s) continue;
    sum.force_m_s2 /= static_cast<double>(i - begin);
    out.push_back(std::exchange(sum, {}));
    begin = i;
  }
  return out;
}

std::string force_remedy(double mean_m_s2) {
  if (const std::optional<ForceUnit> unit = probable_force_unit(mean_m_s2)) {
    return fmt::format(
        "the values are probably in {}: convert them to m/s^2 (factor {:.5g}), gravity included",
        unit->name, unit->factor);
  }
  return mean_m_s2 < kGravity_m_s2 ? "gravity is missing: log the accelerometer itself, gravity "
                                     "included (+9.81 upward at "
                                     "rest), in m/s^2"
                                   : "give it in m/s^2, gravity included";
}

// Hint if the log is about 10^3 or 10^6 times shorter than the flight, or "".
std::string unit_hint(const std::vector<Timestamp>& stamps, double flight_s) {
  constexpr double kMaxFactor = 3;
  const double log_s = seconds_between(stamps.front(), stamps.back());
  for (const auto& [unit, symbol, ratio] :
       {std::tuple{"microseconds", "us", 1e3}, std::tuple{"milliseconds", "ms", 1e6}}) {
    if (ratio * log_s > kMaxFactor * flight_s || kMaxFactor * ratio * log_s < flight_s) continue;
    return fmt::format("; the time stamps are probably {}: name the first column 'timestamp [{}]'",
                       unit, symbol);
  }
  return "";
}

// Nullopt if the log covers the flight.
template <typename Value>
std::optional<std::string> coverage_warning(const TimeSeries<Value>& series, const char* name,
                                            Timestamp first, Timestamp last) {
  constexpr double kMaxUncoveredRatio = 0.1;  // of the flight
  const Timestamp from = std::max(first, series.stamps.front());
  const Timestamp to = std::min(last, series.stamps.back());
  const double flight_s = seconds_between(first, last);
  const double covered_s = std::max(0.0, seconds_between(from, to));
  if (from <= to && covered_s >= (1 - kMaxUncoveredRatio) * flight_s) return std::nullopt;
  const std::string spans = fmt::format(
      "{:.3f} s to {:.3f} s, images from {:.3f} s to {:.3f} s", to_seconds(series.stamps.front()),
      to_seconds(series.stamps.back()), to_seconds(first), to_seconds(last));
  if (from > to) {
    return fmt::format(
        "{0}: no reading within the flight: readings from {1}; use one clock for both, or set "
        "{2}.time_offset_s{3}",
        name, spans, std::string_view(name).substr(0, std::string_view(name).find('.')),
        unit_hint(series.stamps, flight_s));
  }
  return fmt::format("{}: covers {:.1f} s of {:.1f} s: readings from {}{}", name, covered_s,
                     flight_s, spans, unit_hint(series.stamps, flight_s));
}

// Gaps between two readings of the flight.
template <typename Value>
std::optional<std::string> gap_warning(const TimeSeries<Value>& series, const char* name,
                                       Timestamp first, Timestamp last) {
  int count = 0;
  double sum_s = 0, longest_s = 0;
  Timestamp longest_from;
  for (std::size_t i = 1; i < series.stamps.size(); ++i) {
    const double gap_s = seconds_between(series.stamps[i - 1], series.stamps[i]);
    if (gap_s <= series.max_gap_s || series.stamps[i] < first || series.stamps[i - 1] > last) {
      continue;
    }
    ++count;
    sum_s += gap_s;
    if (gap_s > longest_s) longest_from = series.stamps[i - 1];
    longest_s = std::max(longest_s, gap_s);
  }
  if (count == 0) return std::nullopt;
  return fmt::format(
      "{}: {} gap(s) of more than {:.3g} s, {:.3g} s in all, the longest {:.3g} s from {:.3f} s; "
      "they are not interpolated: log every reading",
      name, count, series.max_gap_s, sum_s, longest_s, to_seconds(longest_from));
}

// Motion between two readings is not measured.
template <typename Value>
std::optional<std::string> rate_warning(const TimeSeries<Value>& series, const char* name) {
  const std::optional<double> interval_s = median_interval_s(series.stamps);
  if (!interval_s || *interval_s * kMinImuRate_hz <= 1) return std::nullopt;
  return fmt::format(
      "{}: {:.3g} readings per second; rotation and acceleration between two readings are not "
      "measured, their noise is raised: log at 100 per second or more",
      name, 1 / *interval_s);
}

}  // namespace

std::vector<double> mean_force_magnitudes_m_s2(const TimeSeries<Vector6d>& imu) {
  constexpr double kInterval_s = 1;
  std::vector<double> means_m_s2;
  for (std::size_t begin = 0; begin < imu.stamps.size();) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    std::size_t i = begin;
    for (; i < imu.stamps.size() && seconds_between(imu.stamps[begin], imu.stamps[i]) < kInterval_s;
         ++i) {
      sum += imu.values[i].tail<3>();
    }
    means_m_s2.push_back(sum.norm() / static_cast<double>(i - begin));
    begin = i;
  }
  return means_m_s2;
}

std::optional<ForceUnit> probable_force_unit(double mean_m_s2) {
  constexpr double kMaxDeviation = 0.25;
  constexpr ForceUnit kUnits[] = {
      {"g", kGravity_m_s2}, {"mg or cm/s^2", 1e-3 * kGravity_m_s2}, {"ft/s^2", 0.3048}};
  for (const ForceUnit& unit : kUnits) {
    if (std::abs(unit.factor * mean_m_s2 / kGravity_m_s2 - 1) <= kMaxDeviation) return unit;
  }
  return std::nullopt;
}

void check_specific_forces(const TimeSeries<Vector6d>& imu, const std::string& key,
                           const Eigen::Quaterniond& world_from_body, Timestamp start) {
  constexpr double kInitialInterval_s = 1;
  constexpr double kMinForce_m_s2 = kGravity_m_s2 / 3, kMaxForce_m_s2 = 3 * kGravity_m_s2;
  Eigen::Vector3d initial_sum_m_s2 = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < imu.stamps.size(); ++i) {
    if (std::abs(seconds_between(start, imu.stamps[i])) < kInitialInterval_s)
      initial_sum_m_s2 += imu.values[i].tail<3>();
  }
  std::vector<double> means_m_s2 = mean_force_magnitudes_m_s2(imu);
  const double mean_m_s2 = upper_median(means_m_s2);
  if (mean_m_s2 < kMinForce_m_s2 || mean_m_s2 > kMaxForce_m_s2) {
    throw InputError(
        fmt::format("{}: the mean specific force is {:.3g} m/s^2, expected about {} "
                    "(gravity); {}",
                    key, mean_m_s2, kGravity_m_s2, force_remedy(mean_m_s2)));
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

// f' = R(s w dt)^T f for the mean forces f, f' of consecutive intervals: only tilt, not
// acceleration, scales with the rates.
void check_rate_unit(const TimeSeries<Vector6d>& imu, const std::string& key) {
  constexpr double kMinError_m_s2 = 0.5, kMinErrorRatio = 4;
  constexpr std::size_t kMinPairs = 25;
  const std::vector<IntervalMean> means = interval_means(imu);
  if (means.size() <= kMinPairs) return;
  double as_radians = 0, as_degrees = 0;  // sum |f' - R^T f|^2
  for (std::size_t i = 1; i < means.size(); ++i) {
    const Eigen::Vector3d rotation_rad = 0.5 * (means[i - 1].rotation_rad + means[i].rotation_rad);
    const auto error = [&](double scale) {
      return (means[i].force_m_s2 - so3_exp(-scale * rotation_rad) * means[i - 1].force_m_s2)
          .squaredNorm();
    };
    as_radians += error(1);
    as_degrees += error(kDegree);
  }
  const double min_error = static_cast<double>(means.size()) * kMinError_m_s2 * kMinError_m_s2;
  if (as_radians < std::max(min_error, kMinErrorRatio * kMinErrorRatio * as_degrees)) return;
  throw InputError(fmt::format(
      "{}: the specific force rotates as measured by the angular rates only if these are in deg/s; "
      "convert them to rad/s (factor {:.7g})",
      key, kDegree));
}

std::vector<std::string> coverage_warnings(const SensorLog& log, Timestamp first, Timestamp last) {
  std::vector<std::string> found;
  const auto check = [&](const auto& series, const char* name, bool is_inertial) {
    if (series.stamps.empty()) return;
    for (const auto& message : {coverage_warning(series, name, first, last),
                                is_inertial ? rate_warning(series, name) : std::nullopt,
                                gap_warning(series, name, first, last)}) {
      if (message) found.push_back(*message);
    }
  };
  check(log.imu, "imu.path", true);
  if (log.imu.stamps.empty()) check(log.angular_rate_in_body_rad_s, "gyro.path", true);
  check(log.height_m, "height.path", false);
  check(log.attitude, "attitude.path", false);
  check(log.acceleration, "acceleration.path", false);
  return found;
}

}  // namespace stillkite
