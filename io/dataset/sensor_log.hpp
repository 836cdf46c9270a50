#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <vector>

#include "estimation/verdict.hpp"
#include "geometry/rigid_transform.hpp"
#include "geometry/time.hpp"

namespace stillkite {

struct SensorReadings;

/// Readings with ascending stamps of their own.
template <typename Value>
struct TimeSeries {
  std::vector<Timestamp> stamps;
  std::vector<Value> values;
};

/// What other sensors said during a flight; each may be empty.
struct SensorLog {
  TimeSeries<Eigen::Vector3d> angular_rate_in_body_rad_s;
  TimeSeries<double> height_m;                     ///< of SensorReadings
  ScaleSource height_source = ScaleSource::range;  ///< what measured it
  TimeSeries<Eigen::Quaterniond> attitude;         ///< world_from_body
  TimeSeries<Vector6d> acceleration;               ///< of SensorReadings
  TimeSeries<Vector6d> imu;      ///< angular rate, specific force; of SensorReadings::inertial
  std::size_t imu_left_out = 0;  ///< readings that were none (`without_leaps`)
};

/// Neighbouring readings further apart than this are a gap, in which nothing is known.
inline constexpr double kLongestGap_s = 0.5;

/// A slow sensor's height or attitude holds for this long without a neighbour to interpolate to.
inline constexpr double kFresh_s = 0.05;

/// Readings for the frame at `now`: height and attitude where a reading came since `before`,
/// interpolated at the frame's stamp or, before a gap, as long as it is fresh; acceleration at any
/// stamp; the gyro's mean from `before` to `now` (the integral of the line through its readings);
/// of the IMU the means between its readings, the first and the last cut at `before` and `now`.
/// Else nothing outside a log and in its gaps.
[[nodiscard]] SensorReadings readings_between(const SensorLog& log, Timestamp before,
                                              Timestamp now);

// CSV with a stamp first; see TableReader for the rest and for the errors.
[[nodiscard]] TimeSeries<Eigen::Vector3d> read_gyro(const std::filesystem::path& file);
[[nodiscard]] TimeSeries<double> read_heights(const std::filesystem::path& file);
[[nodiscard]] TimeSeries<Eigen::Quaterniond> read_attitudes(const std::filesystem::path& file);
[[nodiscard]] TimeSeries<Vector6d> read_accelerations(const std::filesystem::path& file);
[[nodiscard]] TimeSeries<Vector6d> read_imu(const std::filesystem::path& file);

/// Without what no body does: rows of zeros, as drivers write them that have nothing to tell, and
/// single readings that leap away from both neighbours by 10 rad/s or 80 m/s^2.
[[nodiscard]] TimeSeries<Vector6d> without_leaps(const TimeSeries<Vector6d>& imu);

}  // namespace stillkite
