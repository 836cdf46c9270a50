#pragma once

#include <optional>

#include "geometry/time.hpp"
#include "io/config/run_config.hpp"
#include "io/dataset/sensor_log.hpp"
#include "navigation/sensor_readings.hpp"

namespace stillkite {

/// Reads the sensor logs of the configuration, on the clock of the images and in the body's axes.
/// `timeshift_cam_imu_s`: of the calibration, for an IMU or gyroscope without time_offset_s. Throws
/// InputError on an invalid file, contradictory keys, and a log without a valid reading.
[[nodiscard]] SensorLog read_sensors(const RunConfig& config,
                                     std::optional<double> timeshift_cam_imu_s);

/// Rotation of the section `key` (imu, gyro), else of the sensor.yaml next to its log, else none.
/// Throws InputError on an invalid one.
[[nodiscard]] Eigen::Quaterniond configured_body_from_sensor(const AxesLogConfig& log,
                                                             const std::string& key);

/// The fusion's noise densities with those of the IMU.
[[nodiscard]] FusionConfig with_imu_noise(FusionConfig fusion, const ImuNoiseConfig& noise);

/// Throws InputError if the specific forces or the range at the first frame contradict the initial
/// state. Adds the offset of a barometer to the initial height.
void reconcile_with_initial_state(const RunConfig& config, const InitialState& initial,
                                  Timestamp first, SensorLog& sensors);

}  // namespace stillkite
