#include "io/sensor_log.hpp"

#include <algorithm>

#include "io/table_geometry.hpp"
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
  if (gap_s > kLongestGap_s) return std::nullopt;
  const double ratio = seconds_between(series.stamps[i - 1], stamp) / gap_s;
  return between(series.values[i - 1], series.values[i], ratio);
}

// A reading counts once, however many frames lie between it and the next; where the next is too
// far to lie on a line with, as it is if it is fresh.
template <typename Value>
std::optional<Value> new_value_at(const TimeSeries<Value>& series, Timestamp before,
                                  Timestamp now) {
  if (before == now) return value_at(series, now);
  const auto after = std::upper_bound(series.stamps.begin(), series.stamps.end(), now);
  if (after == series.stamps.begin()) return std::nullopt;
  const Timestamp last = *(after - 1);
  if (last <= before) return std::nullopt;
  std::optional<Value> value = value_at(series, now);
  if (!value && seconds_between(last, now) <= kFresh_s) {
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
    if (seconds_between(at, *inside) > kLongestGap_s) return std::nullopt;
    step_to(*inside, series.values[static_cast<std::size_t>(inside - series.stamps.begin())]);
  }
  step_to(to, *last);
  return integral / seconds_between(from, to);
}

// Rows of a stamp and what `read_row` makes of the cells after it.
template <typename Value, typename ReadRow>
TimeSeries<Value> read_series(const std::filesystem::path& file, std::size_t columns,
                              const ReadRow& read_row) {
  TableReader table(file, Separator::comma, columns);
  TimeSeries<Value> series;
  while (table.next()) {
    series.stamps.push_back(table.stamp());
    series.values.push_back(read_row(table));
  }
  if (series.stamps.empty()) throw InputError(file.string() + ": has no row of data");
  return series;
}

}  // namespace

SensorReadings readings_between(const SensorLog& log, Timestamp before, Timestamp now) {
  return {
      .mean_angular_rate_in_body_rad_s = mean_between(log.angular_rate_in_body_rad_s, before, now),
      .height_m = new_value_at(log.height_m, before, now),
      .height_source = log.height_source,
      .attitude = new_value_at(log.attitude, before, now),
      .acceleration = value_at(log.acceleration, now)};
}

TimeSeries<Eigen::Vector3d> read_gyro(const std::filesystem::path& file) {
  return read_series<Eigen::Vector3d>(file, 4,
                                      [](const TableReader& row) { return vector_at(row, 1); });
}

TimeSeries<double> read_heights(const std::filesystem::path& file) {
  return read_series<double>(file, 2, [](const TableReader& row) { return row.number(1); });
}

TimeSeries<Eigen::Quaterniond> read_attitudes(const std::filesystem::path& file) {
  return read_series<Eigen::Quaterniond>(
      file, 5, [](const TableReader& row) { return quaternion_at(row, 1, 2); });
}

TimeSeries<Vector6d> read_accelerations(const std::filesystem::path& file) {
  return read_series<Vector6d>(file, 4, [](const TableReader& row) {
    Vector6d value = Vector6d::Zero();
    value.head<3>() = vector_at(row, 1);
    if (row.columns() >= 7) value.tail<3>() = vector_at(row, 4);
    return value;
  });
}

}  // namespace stillkite
