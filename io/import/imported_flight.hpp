#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "geometry/fields.hpp"
#include "geometry/time.hpp"
#include "io/config/camera_config.hpp"
#include "io/dataset/sensor_log.hpp"

namespace stillkite {

/// Position of a GNSS receiver, WGS 84.
struct GeodeticPosition {
  double latitude_deg = 0;
  double longitude_deg = 0;
  double altitude_m = 0;  ///< above the ellipsoid or the mean sea level, as recorded
};

/// One line of the report of an import.
struct ImportNote {
  enum class Kind { found, missing, assumed };
  Kind kind = Kind::found;
  std::string text;
};

void add_note(std::vector<ImportNote>& notes, ImportNote::Kind kind, std::string text);

/// Sensors of a recording. Body: x forward, y left, z up; world: x east, y north, z up. Stamps are
/// on the recording's clock. Each series may be empty.
struct ImportedFlight {
  TimeSeries<Eigen::Vector3d> angular_rate_in_body_rad_s;
  TimeSeries<Eigen::Vector3d> specific_force_in_body_m_s2;  ///< +9.81 upward at rest
  TimeSeries<double> range_m;               ///< distance to the ground along the body's -z
  TimeSeries<double> height_m;              ///< barometric; change since the first reading
  TimeSeries<Eigen::Quaterniond> attitude;  ///< world_from_body
  TimeSeries<GeodeticPosition> positions;
  TimeSeries<Eigen::Vector3d> velocity_in_world_m_s;
  std::optional<double> initial_height_m;    ///< over the ground at the first image
  std::optional<double> takeoff_altitude_m;  ///< GeodeticPosition::altitude_m of the ground
  std::optional<double> mount_down_deg;      ///< optical axis below the body's horizon
  std::optional<double> horizontal_fov_deg;  ///< nominal
  std::optional<CameraConfig> camera;        ///< calibration in the recording
  bool is_fisheye = false;                   ///< nominal lens: equidistant, else pinhole
  std::size_t rejected = 0;                  ///< readings out of range or with a stamp out of order
  std::vector<ImportNote> notes;

  void found(std::string text) { add_note(notes, ImportNote::Kind::found, std::move(text)); }
  void missing(std::string text) { add_note(notes, ImportNote::Kind::missing, std::move(text)); }
  void assumed(std::string text) { add_note(notes, ImportNote::Kind::assumed, std::move(text)); }
};

[[nodiscard]] inline bool is_valid(double value) {
  return std::abs(value) < 1e5;
}
[[nodiscard]] inline bool is_valid(const Eigen::Vector3d& v) {
  return (v.array().abs() < 2000).all();
}
[[nodiscard]] inline bool is_valid(const Eigen::Quaterniond& q) {
  return std::abs(q.norm() - 1) < 0.01;
}
/// False also at (0, 0), which receivers report without a fix.
[[nodiscard]] inline bool is_valid(const GeodeticPosition& p) {
  return std::abs(p.latitude_deg) <= 90 && std::abs(p.longitude_deg) <= 180 &&
         std::abs(p.altitude_m) < 1e5 && (p.latitude_deg != 0 || p.longitude_deg != 0);
}

/// Appends a reading; one with the last stamp is a repetition and not appended. Out of range, or
/// with an earlier stamp or one a day later, it is counted in `rejected` instead. Throws InputError
/// beyond 2e7 readings (a day at 200 Hz).
template <typename Value>
void append(TimeSeries<Value>& series, Timestamp stamp, const Value& value, std::size_t& rejected) {
  constexpr std::size_t kMaxReadings = 20'000'000;
  constexpr std::int64_t kMaxGap_ns = 86'400'000'000'000;
  if (series.stamps.size() >= kMaxReadings) {
    throw InputError("more than 2e7 readings of one sensor; import a shorter recording");
  }
  const std::int64_t step_ns = series.stamps.empty() ? 1 : stamp.ns - series.stamps.back().ns;
  if (step_ns == 0) return;  // the same message again
  if (step_ns < 0 || step_ns > kMaxGap_ns || !is_valid(value)) {
    ++rejected;
    return;
  }
  series.stamps.push_back(stamp);
  series.values.push_back(value);
}

/// Stamp of a count of microseconds; nullopt beyond 200 years, so that differences do not overflow.
[[nodiscard]] inline std::optional<Timestamp> from_microseconds(std::uint64_t t_us) {
  constexpr std::uint64_t kMax_us = 6'311'520'000'000'000;
  if (t_us > kMax_us) return std::nullopt;
  return Timestamp{static_cast<std::int64_t>(t_us) * 1000};
}

}  // namespace stillkite
