#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>

#include "io/dataset/sensor_log.hpp"
#include "io/setup/setup_finding.hpp"

// Questions about an IMU log alone, and about gravity. Bounds: docs/check.md.

namespace stillkite {

/// The log with the first three columns behind the last three.
[[nodiscard]] TimeSeries<Vector6d> with_swapped_columns(TimeSeries<Vector6d> imu);

/// True if the first three columns have the magnitude of gravity and the last three do not: the
/// specific force comes before the angular rate.
[[nodiscard]] bool has_swapped_columns(const TimeSeries<Vector6d>& imu);

/// Size of gravity: units and scale of the accelerometer. `imu`: not empty.
[[nodiscard]] SetupFinding gravity_size_finding(const TimeSeries<Vector6d>& imu);

/// White noise densities in units of the configuration.
struct ImuDensities {
  double gyro = 0;   ///< rad/s/sqrt(Hz)
  double accel = 0;  ///< m/s^2/sqrt(Hz)
};

/// By second differences, which have six times the variance of the noise; median over half seconds.
/// Includes vibration. Nullopt below 1 s.
[[nodiscard]] std::optional<ImuDensities> measured_densities(const TimeSeries<Vector6d>& imu);

[[nodiscard]] SetupFinding imu_noise_finding(const TimeSeries<Vector6d>& imu,
                                             const ImuDensities& configured);

/// Mean specific force in body axes at the first frame: opposite to gravity up to the mean
/// acceleration.
struct UpDirection {
  Eigen::Vector3d up_in_body = Eigen::Vector3d::UnitZ();  ///< unit vector
  double sigma_rad = 0;
  double duration_s = 0;
};

/// From the readings within 10 s from `first`, rotated to it by the angular rate less its bias;
/// without a bias within 2 s and not rotated. Nullopt with less than 1 s of readings.
[[nodiscard]] std::optional<UpDirection> up_direction(
    const TimeSeries<Vector6d>& imu, Timestamp first,
    const std::optional<Eigen::Vector3d>& gyro_bias_rad_s);

/// Direction of gravity against the initial roll and pitch. `source`: of the initial attitude.
[[nodiscard]] SetupFinding initial_attitude_finding(const UpDirection& measured,
                                                    const Eigen::Quaterniond& world_from_body,
                                                    const char* source);

}  // namespace stillkite
