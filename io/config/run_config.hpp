#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/config/camera_config.hpp"
#include "io/config/input_config.hpp"
#include "io/config/shadow_config.hpp"
#include "io/config/source_config.hpp"
#include "navigation/navigator_config.hpp"
#include "stabilization/hold_config.hpp"

namespace stillkite {

struct OutputConfig {
  bool overlay = false;

  static void fields(auto& self, auto&& field) {
    field("overlay", self.overlay,
          "write overlay.mp4: flow, horizon, velocity and verdict drawn over the frames");
  }
};

/// Configuration of `stillkite run`.
struct RunConfig {
  SourceConfig source;
  CalibrationConfig calibration;
  MountConfig mount;
  TruthConfig truth;
  InitialConfig initial;
  HeightConfig height;
  AxesLogConfig gyro;
  ImuLogConfig imu;
  AxesLogConfig attitude;
  LogConfig acceleration;
  EstimatorConfig estimator;
  NavigatorConfig navigator;
  ShadowConfig shadow;
  HoldConfig hold;
  OutputConfig output;

  [[nodiscard]] bool has_shadow() const {
    return shadow.enabled.value_or(estimator.policy != Policy::flow);
  }

  static void fields(auto& self, auto&& field) {
    field("source", self.source, "the images");
    field("calibration", self.calibration, "camera intrinsics and mask");
    field("mount", self.mount, "camera extrinsics: body from camera");
    field("truth", self.truth, "ground truth for the evaluation");
    field("initial", self.initial, "initial pose and height");
    field("height", self.height, "height sensor");
    field("gyro", self.gyro, "angular rate in the body, rad/s: wx, wy, wz (or EuRoC imu0)");
    field(
        "imu", self.imu,
        "IMU for the fusion, replaces gyro: angular rate, rad/s, and specific force, m/s^2, in the "
        "body: wx, wy, wz, ax, ay, az (EuRoC imu0)");
    field("attitude", self.attitude, "attitude log, quaternion world from body: qw, qx, qy, qz");
    field("acceleration", self.acceleration,
          "a(t) of the flow paper: linear acceleration ax, ay, az in the world, m/s^2 [, angular "
          "acceleration in the body, rad/s^2]");
    field("estimator", self.estimator, "estimator selection");
    field("navigator", self.navigator, "flow navigator");
    field("reference", self.navigator.reference, "relative pose to a reference image");
    field("choice", self.navigator.choice, "selection between flow and reference for each frame");
    field("fusion", self.navigator.fusion, "visual-inertial filter of flow and reference");
    field("shadow", self.shadow, "controller in shadow mode: computes commands, none is flown");
    field("hold", self.hold, "hold controller");
    field("output", self.output, "additional output files");
  }
};

/// Configuration of a file (without one: the defaults) with overrides `key.path=value`.
[[nodiscard]] RunConfig load_run_config(const std::optional<std::filesystem::path>& file,
                                        const std::vector<std::string>& overrides);

}  // namespace stillkite
