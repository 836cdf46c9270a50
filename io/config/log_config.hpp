#pragma once

#include <array>
#include <filesystem>
#include <optional>

#include "geometry/fields.hpp"

namespace stillkite {

inline constexpr Range kTimeOffset_s{-4e9, 4e9};

struct LogConfig {
  std::optional<std::filesystem::path> path;
  std::optional<double> time_offset_s;

  static void fields(auto& self, auto&& field) {
    field("path", self.path,
          "CSV, time stamp in the first column; without it the sensor is not used");
    field("time_offset_s", self.time_offset_s, kTimeOffset_s,
          "added to the log's stamps, so that they are on the clock of the images; default: minus "
          "timeshift_cam_imu of the calibration for imu and gyro, else 0");
  }
};

/// Log of a sensor with axes of its own.
struct AxesLogConfig : LogConfig {
  std::optional<std::array<double, 4>> rotation_wxyz;

  static void fields(auto& self, auto&& field) {
    LogConfig::fields(self, field);
    field("rotation_wxyz", self.rotation_wxyz,
          "quaternion body from sensor; default: T_BS of an IMU's sensor.yaml next to the log, "
          "else no rotation");
  }
};

/// Noise of an IMU; unset values are those of `fusion`.
struct ImuNoiseConfig {
  std::optional<double> gyro_density;
  std::optional<double> gyro_bias_walk;
  std::optional<double> accel_density;
  std::optional<double> accel_bias_walk;

  static void fields(auto& self, auto&& field) {
    field("gyro_density", self.gyro_density, Range{1e-9, 1e9},
          "white noise, rad/s/sqrt(Hz); default: fusion.gyro_density, or that of the log's "
          "sensor.yaml if larger");
    field("gyro_bias_walk", self.gyro_bias_walk, Range{0, 1e9},
          "rad/s^2/sqrt(Hz); default as above, of fusion.gyro_bias_walk");
    field("accel_density", self.accel_density, Range{1e-9, 1e9},
          "white noise, m/s^2/sqrt(Hz); default as above, of fusion.accel_density");
    field("accel_bias_walk", self.accel_bias_walk, Range{0, 1e9},
          "m/s^3/sqrt(Hz); default as above, of fusion.accel_bias_walk");
  }
};

struct ImuLogConfig : AxesLogConfig {
  ImuNoiseConfig noise;

  static void fields(auto& self, auto&& field) {
    AxesLogConfig::fields(self, field);
    field("noise", self.noise, "noise densities of the IMU");
  }
};

}  // namespace stillkite
