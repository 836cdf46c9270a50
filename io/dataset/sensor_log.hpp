#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <vector>

#include "estimation/verdict.hpp"
#include "geometry/rigid_transform.hpp"
#include "geometry/time.hpp"
#include "io/config/input_config.hpp"

namespace stillkite {

struct SensorReadings;

/// Readings further apart are not interpolated, whatever their rate.
inline constexpr double kMaxGap_s = 0.5;

/// Sensor readings with ascending time stamps.
template <typename Value>
struct TimeSeries {
  std::vector<Timestamp> stamps;
  std::vector<Value> values;
  double max_gap_s = kMaxGap_s;  ///< readings further apart are not interpolated
};

/// Interval above which a log has a gap: 2.5 median intervals, at least 20 ms, at most kMaxGap_s.
[[nodiscard]] double max_gap_s(const std::vector<Timestamp>& stamps);

/// Median interval between readings; nullopt below two readings.
[[nodiscard]] std::optional<double> median_interval_s(const std::vector<Timestamp>& stamps);

/// Readings of all sensors of a flight except the camera; each series may be empty.
struct SensorLog {
  TimeSeries<Eigen::Vector3d> angular_rate_in_body_rad_s;
  TimeSeries<double> height_m;                     ///< as SensorReadings::height_m
  ScaleSource height_source = ScaleSource::range;  ///< sensor of height_m
  TimeSeries<Eigen::Quaterniond> attitude;         ///< world_from_body
  TimeSeries<Vector6d> acceleration;               ///< as SensorReadings::acceleration
  TimeSeries<Vector6d> imu;  ///< angular rate, specific force; as SensorReadings::inertial
  std::size_t rejected_imu_readings = 0;  ///< count of reject_imu_outliers
  ImuNoiseConfig imu_noise;     ///< of the configuration, else imu0/sensor.yaml; of low rates
  double rate_sigma_rad_s = 0;  ///< of angular rates between readings of a low rate
  double imu_lever_arm_m = 0;   ///< from the body's origin, by imu0/sensor.yaml
};

/// A height or attitude reading is held for this long if it cannot be interpolated.
inline constexpr double kMaxReadingAge_s = 0.05;

/// Readings for the frame at `now`; nullopt or empty outside a log and in its gaps.
/// - Height, attitude: interpolated at `now` if a reading arrived since `before`; before a gap the
///   last one, up to kMaxReadingAge_s.
/// - Acceleration: interpolated at `now`.
/// - Angular rate: mean from `before` to `now` of the piecewise linear signal.
/// - IMU: mean of each interval between readings, the first and last clipped to [before, now].
[[nodiscard]] SensorReadings readings_between(const SensorLog& log, Timestamp before,
                                              Timestamp now);

// CSV files, time stamp in the first column; format and errors as in TableReader. The stamps of
// gyro and IMU are without their jitter (StampFilter).
[[nodiscard]] TimeSeries<Eigen::Vector3d> read_gyro(const std::filesystem::path& file);
[[nodiscard]] TimeSeries<double> read_heights(const std::filesystem::path& file);
[[nodiscard]] TimeSeries<Eigen::Quaterniond> read_attitudes(const std::filesystem::path& file);
[[nodiscard]] TimeSeries<Vector6d> read_accelerations(const std::filesystem::path& file);
[[nodiscard]] TimeSeries<Vector6d> read_imu(const std::filesystem::path& file);

/// True for the readings after the first of a run of at least 20 equal ones over 0.25 s: a sensor
/// that has stopped, while its driver goes on. Noise makes a working one's readings differ.
[[nodiscard]] std::vector<bool> repeated_readings(const TimeSeries<Vector6d>& imu);

/// Removes rows of zeros (written by drivers without a measurement), repeated readings, and single
/// readings that differ from both neighbours by more than 10 rad/s or 80 m/s^2.
[[nodiscard]] TimeSeries<Vector6d> reject_imu_outliers(const TimeSeries<Vector6d>& imu);

}  // namespace stillkite
