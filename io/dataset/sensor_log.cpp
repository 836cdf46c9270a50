#include "io/dataset/sensor_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <span>
#include <string>
#include <utility>

#include "geometry/stamp_filter.hpp"
#include "io/dataset/table_geometry.hpp"
#include "navigation/navigator.hpp"

namespace stillkite {
namespace {

double between(double a, double b, double ratio) {
  return a + ratio * (b - a);
}

template <int N>
Eigen::Matrix<double, N, 1> between(const Eigen::Matrix<double, N, 1>& a,
                                    const Eigen::Matrix<double, N, 1>& b, double ratio) {
  return a + ratio * (b - a);
}

Eigen::Quaterniond between(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b, double ratio) {
  return a.slerp(ratio, b);
}

template <typename Value>
std::optional<Value> value_at(const TimeSeries<Value>& series, Timestamp stamp) {
  const auto after = std::lower_bound(series.stamps.begin(), series.stamps.end(), stamp);
  if (after == series.stamps.end()) return std::nullopt;
  const auto i = static_cast<std::size_t>(after - series.stamps.begin());
  if (*after == stamp) return series.values[i];
  if (i == 0) return std::nullopt;
  const double gap_s = seconds_between(series.stamps[i - 1], *after);
  if (gap_s > series.max_gap_s) return std::nullopt;
  const double ratio = seconds_between(series.stamps[i - 1], stamp) / gap_s;
  return between(series.values[i - 1], series.values[i], ratio);
}

// Each reading is used once, at the first frame after it. Without interpolation (gap) the reading
// itself is returned up to kMaxReadingAge_s.
template <typename Value>
std::optional<Value> new_value_at(const TimeSeries<Value>& series, Timestamp before,
                                  Timestamp now) {
  if (before == now) return value_at(series, now);
  const auto after = std::upper_bound(series.stamps.begin(), series.stamps.end(), now);
  if (after == series.stamps.begin()) return std::nullopt;
  const Timestamp last = *(after - 1);
  if (last <= before) return std::nullopt;
  std::optional<Value> value = value_at(series, now);
  if (!value && seconds_between(last, now) <= kMaxReadingAge_s) {
    value = series.values[static_cast<std::size_t>(after - series.stamps.begin()) - 1];
  }
  return value;
}

std::optional<Eigen::Vector3d> mean_between(const TimeSeries<Eigen::Vector3d>& series,
                                            Timestamp from, Timestamp to) {
  const std::optional<Eigen::Vector3d> first = value_at(series, from);
  const std::optional<Eigen::Vector3d> last = value_at(series, to);
  if (!first || !last || from >= to) return std::nullopt;
  Eigen::Vector3d integral = Eigen::Vector3d::Zero();
  Timestamp at = from;
  Eigen::Vector3d value = *first;
  const auto step_to = [&](Timestamp next, const Eigen::Vector3d& next_value) {
    integral += 0.5 * seconds_between(at, next) * (value + next_value);
    at = next;
    value = next_value;
  };
  auto inside = std::upper_bound(series.stamps.begin(), series.stamps.end(), from);
  for (; *inside < to; ++inside) {
    if (seconds_between(at, *inside) > series.max_gap_s) return std::nullopt;
    step_to(*inside, series.values[static_cast<std::size_t>(inside - series.stamps.begin())]);
  }
  step_to(to, *last);
  return integral / seconds_between(from, to);
}

std::vector<InertialReading> inertial_between(const TimeSeries<Vector6d>& series, Timestamp from,
                                              Timestamp to) {
  std::vector<InertialReading> readings;
  Timestamp at = from;
  std::optional<Vector6d> value = value_at(series, from);
  std::optional<Timestamp> after_gap;
  const auto step_to = [&](Timestamp next, const Vector6d& next_value) {
    if (value && seconds_between(at, next) <= series.max_gap_s) {
      const Vector6d mean = 0.5 * (*value + next_value);
      readings.push_back({.stamp = next,
                          .angular_rate_in_body_rad_s = mean.head<3>(),
                          .specific_force_in_body_m_s2 = mean.tail<3>(),
                          .valid_from = std::exchange(after_gap, std::nullopt)});
    } else {
      after_gap = next;
    }
    at = next;
    value = next_value;
  };
  const auto first = std::upper_bound(series.stamps.begin(), series.stamps.end(), from);
  const auto last = std::lower_bound(first, series.stamps.end(), to);
  readings.reserve(static_cast<std::size_t>(last - first) + 1);
  for (auto inside = first; inside != last; ++inside) {
    step_to(*inside, series.values[static_cast<std::size_t>(inside - series.stamps.begin())]);
  }
  if (const std::optional<Vector6d> end = value_at(series, to); end && to > at) step_to(to, *end);
  return readings;
}

// Plausible ranges; values outside are in another unit or damaged.
constexpr Range kRates_rad_s{-100, 100};
constexpr Range kForces_m_s2{-2000, 2000};

Eigen::Vector3d rates_at(const TableReader& row) {
  const Eigen::Vector3d rates_rad_s = vector_at(row, 1);
  for (std::size_t i = 0; i < 3; ++i) {
    const double rate_rad_s = rates_rad_s[static_cast<Eigen::Index>(i)];
    if (kRates_rad_s.contains(rate_rad_s)) continue;
    row.reject(fmt::format(
        "{}: {} is out of range, allowed: [{}, {}] rad/s; if the log is in deg/s, convert it to "
        "rad/s (factor 0.01745329)",
        row.column_name(i + 1), rate_rad_s, kRates_rad_s.min, kRates_rad_s.max));
  }
  return rates_rad_s;
}

Eigen::Vector3d forces_at(const TableReader& row) {
  const Eigen::Vector3d forces_m_s2 = vector_at(row, 4);
  for (std::size_t i = 0; i < 3; ++i) {
    const double force_m_s2 = forces_m_s2[static_cast<Eigen::Index>(i)];
    if (kForces_m_s2.contains(force_m_s2)) continue;
    row.reject(fmt::format(
        "{}: {} is out of range, allowed: [{}, {}] m/s^2; convert raw counts and mg to m/s^2",
        row.column_name(i + 4), force_m_s2, kForces_m_s2.min, kForces_m_s2.max));
  }
  return forces_m_s2;
}

std::vector<Timestamp> without_jitter(std::span<const Timestamp> stamps) {
  StampFilter filter;
  filter.initialize(stamps);
  std::vector<Timestamp> out;
  out.reserve(stamps.size());
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    out.push_back(filter.next(stamps[i], stamps.subspan(i + 1)).stamp);
  }
  return out;
}

// Series of (stamp, read_row(row)).
template <typename Value, typename ReadRow>
TimeSeries<Value> read_series(const std::filesystem::path& file, std::size_t columns,
                              std::vector<Column> expected, const ReadRow& read_row) {
  TableReader table(file, Separator::comma, columns, std::move(expected));
  TimeSeries<Value> series;
  while (table.next()) {
    series.stamps.push_back(table.stamp());
    series.values.push_back(read_row(table));
  }
  if (series.stamps.empty()) throw InputError(file.string() + ": no data row");
  series.max_gap_s = max_gap_s(series.stamps);
  return series;
}

}  // namespace

std::optional<double> median_interval_s(const std::vector<Timestamp>& stamps) {
  if (stamps.size() < 2) return std::nullopt;
  std::vector<double> intervals_s;
  intervals_s.reserve(stamps.size() - 1);
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    intervals_s.push_back(seconds_between(stamps[i - 1], stamps[i]));
  }
  const auto middle = intervals_s.begin() + std::ssize(intervals_s) / 2;
  std::nth_element(intervals_s.begin(), middle, intervals_s.end());
  return *middle;
}

double max_gap_s(const std::vector<Timestamp>& stamps) {
  constexpr double kMaxIntervals = 2.5, kMinGap_s = 0.02;
  const std::optional<double> interval_s = median_interval_s(stamps);
  return interval_s ? std::clamp(kMaxIntervals * *interval_s, kMinGap_s, kMaxGap_s) : kMaxGap_s;
}

SensorReadings readings_between(const SensorLog& log, Timestamp before, Timestamp now) {
  return {
      .mean_angular_rate_in_body_rad_s = mean_between(log.angular_rate_in_body_rad_s, before, now),
      .height_m = new_value_at(log.height_m, before, now),
      .height_source = log.height_source,
      .attitude = new_value_at(log.attitude, before, now),
      .acceleration = value_at(log.acceleration, now),
      .inertial = inertial_between(log.imu, before, now)};
}

TimeSeries<Eigen::Vector3d> read_gyro(const std::filesystem::path& file) {
  auto rates =
      read_series<Eigen::Vector3d>(file, 4, vector_columns({Quantity::angular_rate}), rates_at);
  rates.stamps = without_jitter(rates.stamps);
  return rates;
}

TimeSeries<double> read_heights(const std::filesystem::path& file) {
  return read_series<double>(file, 2, {{Quantity::height}},
                             [](const TableReader& row) { return row.number(1); });
}

TimeSeries<Eigen::Quaterniond> read_attitudes(const std::filesystem::path& file) {
  return read_series<Eigen::Quaterniond>(
      file, 5,
      {{Quantity::quaternion, 'w'},
       {Quantity::quaternion, 'x'},
       {Quantity::quaternion, 'y'},
       {Quantity::quaternion, 'z'}},
      [](const TableReader& row) { return quaternion_at(row, 1, 2); });
}

TimeSeries<Vector6d> read_accelerations(const std::filesystem::path& file) {
  return read_series<Vector6d>(
      file, 4, vector_columns({Quantity::acceleration, Quantity::angular_acceleration}),
      [](const TableReader& row) {
        Vector6d value = Vector6d::Zero();
        value.head<3>() = vector_at(row, 1);
        if (row.columns() >= 7) value.tail<3>() = vector_at(row, 4);
        return value;
      });
}

TimeSeries<Vector6d> read_imu(const std::filesystem::path& file) {
  auto imu = read_series<Vector6d>(file, 7,
                                   vector_columns({Quantity::angular_rate, Quantity::acceleration}),
                                   [](const TableReader& row) {
                                     const Eigen::Vector3d rates = rates_at(row);
                                     const Eigen::Vector3d forces = forces_at(row);
                                     return (Vector6d() << rates, forces).finished();
                                   });
  imu.stamps = without_jitter(imu.stamps);
  return imu;
}

std::vector<bool> repeated_readings(const TimeSeries<Vector6d>& imu) {
  constexpr double kMinDuration_s = 0.25;
  constexpr std::size_t kMinReadings = 20;
  std::vector<bool> repeated(imu.values.size(), false);
  for (std::size_t first = 0; first < imu.values.size();) {
    std::size_t end = first + 1;
    while (end < imu.values.size() && imu.values[end] == imu.values[first]) ++end;
    if (end - first >= kMinReadings &&
        seconds_between(imu.stamps[first], imu.stamps[end - 1]) >= kMinDuration_s) {
      std::fill(repeated.begin() + std::ptrdiff_t(first) + 1,
                repeated.begin() + std::ptrdiff_t(end), true);
    }
    first = end;
  }
  return repeated;
}

TimeSeries<Vector6d> reject_imu_outliers(const TimeSeries<Vector6d>& imu) {
  constexpr double kMaxJump_rad_s = 10, kMaxJump_m_s2 = 80;
  const auto jumps_from = [&](const Vector6d& value, const Vector6d& neighbour) {
    const Vector6d jump = value - neighbour;
    return jump.head<3>().norm() > kMaxJump_rad_s || jump.tail<3>().norm() > kMaxJump_m_s2;
  };
  TimeSeries<Vector6d> out{.stamps = {}, .values = {}, .max_gap_s = imu.max_gap_s};
  const std::size_t n = imu.values.size();
  const std::vector<bool> repeated = repeated_readings(imu);
  for (std::size_t i = 0; i < n; ++i) {
    const Vector6d& value = imu.values[i];
    const bool is_spike = i > 0 && i + 1 < n && jumps_from(value, imu.values[i - 1]) &&
                          jumps_from(value, imu.values[i + 1]);
    if (is_spike || repeated[i] || value.isZero(0)) continue;
    out.stamps.push_back(imu.stamps[i]);
    out.values.push_back(value);
  }
  return out;
}

}  // namespace stillkite
