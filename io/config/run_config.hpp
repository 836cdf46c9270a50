#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/config/camera_config.hpp"
#include "io/config/shadow_config.hpp"
#include "io/config/source_config.hpp"
#include "io/config/start_config.hpp"
#include "navigation/navigator_config.hpp"
#include "stabilization/hold_config.hpp"

namespace stillkite {

struct OutputConfig {
  bool overlay = false;

  static void fields(auto& self, auto&& field) {
    field("overlay", self.overlay,
          "overlay.mp4: what was seen and concluded, drawn over the frames");
  }
};

/// All that `stillkite run` can be told.
struct RunConfig {
  SourceConfig source;
  CalibrationConfig calibration;
  MountConfig mount;
  TruthConfig truth;
  InitialConfig initial;
  HeightConfig height;
  LogConfig gyro;
  LogConfig imu;
  LogConfig attitude;
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
    field("calibration", self.calibration, "the lens");
    field("mount", self.mount, "the camera in the body");
    field("truth", self.truth, "what the answer is compared with");
    field("initial", self.initial, "where the flight starts");
    field("height", self.height, "another sensor's height");
    field("gyro", self.gyro, "angular rates of the body, rad/s: wx, wy, wz (EuRoC's imu0 too)");
    field("imu", self.imu,
          "instead of gyro, for the fusion: angular rates and specific forces of the body, m/s^2: "
          "wx, wy, wz, ax, ay, az (EuRoC's imu0)");
    field("attitude", self.attitude, "world from body: qw, qx, qy, qz");
    field("acceleration", self.acceleration,
          "a(t) of the flow paper: ax, ay, az in the world, m/s^2 [, angular in the body]");
    field("estimator", self.estimator, "how the motion is found");
    field("navigator", self.navigator, "the flow navigator");
    field("reference", self.navigator.reference, "the reference estimator");
    field("choice", self.navigator.choice, "of either estimator's answer, frame by frame");
    field("fusion", self.navigator.fusion, "both estimators in one filter");
    field("shadow", self.shadow, "the controller beside the recording");
    field("hold", self.hold, "the controller");
    field("output", self.output, "files beside the estimates");
  }
};

/// The configuration of a file (none: the defaults) under the command line's key=value's.
[[nodiscard]] RunConfig load_run_config(const std::optional<std::filesystem::path>& file,
                                        const std::vector<std::string>& overrides);

}  // namespace stillkite
