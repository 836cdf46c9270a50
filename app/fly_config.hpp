#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/config/run_config.hpp"
#include "live/live_config.hpp"
#include "live/stream/stream_config.hpp"

namespace stillkite {

/// IMU of a live flight.
struct FlyImuConfig {
  std::optional<std::array<double, 4>> rotation_wxyz;
  ImuNoiseConfig noise;

  static void fields(auto& self, auto&& field) {
    field("rotation_wxyz", self.rotation_wxyz,
          "quaternion of our body from the sensors', both forward, left, up; default: the same");
    field("noise", self.noise, "noise densities of the IMU");
  }
};

/// Configuration of `stillkite fly`. Calibration, initial state and estimator as for `run`.
struct FlyConfig {
  StreamConfig source;
  CalibrationConfig calibration;
  MountConfig mount;
  InitialConfig initial;
  FlyImuConfig imu;
  EstimatorConfig estimator;
  NavigatorConfig navigator;
  HoldConfig hold;
  LiveConfig live;

  static void fields(auto& self, auto&& field) {
    field("source", self.source, "live video");
    field("calibration", self.calibration, "camera intrinsics and mask");
    field("mount", self.mount, "camera extrinsics: body from camera");
    field("initial", self.initial, "initial pose and height");
    field("imu", self.imu, "IMU of the autopilot or of sensor lines, see live.telemetry.imu");
    field("estimator", self.estimator, "estimator selection");
    field("navigator", self.navigator, "flow navigator");
    field("reference", self.navigator.reference, "relative pose to a reference image");
    field("choice", self.navigator.choice, "selection between flow and reference for each frame");
    field("fusion", self.navigator.fusion, "visual-inertial filter of flow and reference");
    field("hold", self.hold, "hold controller, see live.tether");
    field("live", self.live, "connections");
  }
};

/// Configuration of a file with overrides `key.path=value`. `source.path` keeps its environment
/// variables, so that credentials are not printed; an SDP file is absolute. Throws InputError.
[[nodiscard]] FlyConfig load_fly_config(const std::optional<std::filesystem::path>& file,
                                        const std::vector<std::string>& overrides);

/// The part that an estimator's inputs are read from; it names no sensor log.
[[nodiscard]] RunConfig run_config_of(const FlyConfig& config);

}  // namespace stillkite
