#pragma once

#include <optional>

#include "simulation/flight/simulation_config.hpp"
#include "simulation/hover/fault.hpp"
#include "simulation/hover/hover_sensors.hpp"
#include "simulation/hover/sea_motion.hpp"
#include "simulation/hover/station_path.hpp"
#include "simulation/hover/tethered_drone.hpp"
#include "simulation/hover/wind.hpp"
#include "simulation/hover/yaw_kicks.hpp"
#include "simulation/scene/moving_objects.hpp"

namespace stillkite {

/// A wide-angle action camera's stream of 800x480, tilted down by 15 degrees from straight ahead.
[[nodiscard]] inline SimulatedCameraConfig hover_camera() {
  return {.frames_per_s = 30,
          .width_px = 800,
          .height_px = 480,
          .focal_x_px = 480,
          .focal_y_px = 480,
          .centre_x_px = 399.5,
          .centre_y_px = 239.5,
          .distortion = DistortionModel::radial_tangential,
          .coefficients = {-0.28, 0.07, 2e-4, -1e-4},
          .forward_tilt_deg = 75,
          // with 2 edges move by quarter pixels, in windows of all flights alike
          .supersampling = 4,
          .shutter_s = 0.008};
}

/// Everything about a trial's world but its scene and the controller: figures mean something only
/// beside these.
struct PlantConfig {
  TetheredDroneConfig drone{};
  SimulatedCameraConfig camera = hover_camera();
  double camera_latency_s = 0.1;
  HoverSensorConfig sensors{};
  StationPathConfig station{};
  std::optional<SeaConfig> sea{};
  WindConfig wind{};
  std::optional<YawKickConfig> yaw_kicks{};
  double contrast_ratio = 1;
  std::optional<MovingObjectConfig> moving_objects{};
  std::optional<FaultConfig> fault{};

  static void fields(auto& self, auto&& field) {
    field("drone", self.drone, "tether, limits, lag and what wind does");
    field("camera", self.camera, "lens, sensor and the gimbal's tilt");
    field("camera_latency_s", self.camera_latency_s, kNotNegative,
          "from a frame's exposure to its arrival at the estimator");
    field("sensors", self.sensors, "what the controller learns beside images");
    field("station", self.station, "the way of the ground station");
    field("sea", self.sea, "that carries the station's boat; null: it stands on land");
    field("wind", self.wind, "mean and gusts");
    field("yaw_kicks", self.yaw_kicks, "what turns the drone; null: nothing");
    field("contrast_ratio", self.contrast_ratio, Range{0, 1},
          "of the scene, about a middle grey; below 1 as in haze, and the noise stays");
    field("moving_objects", self.moving_objects, "what moves before the camera; null: nothing");
    field("fault", self.fault, "what goes wrong for a while; null: nothing");
  }
};

}  // namespace stillkite
