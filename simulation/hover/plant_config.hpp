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

/// Wide-angle action camera, 800x480, optical axis 15 degrees below the horizontal.
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
          // with 2, edges move in steps of a quarter pixel: errors correlated over all flights
          .supersampling = 4,
          .shutter_s = 0.008};
}

/// Plant of a trial: drone, camera, sensors, station and disturbances. Figures of different runs
/// are comparable only with equal values.
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
    field("drone", self.drone, "tether, limits, lag and wind response");
    field("camera", self.camera, "lens, sensor and tilt of the gimbal");
    field("camera_latency_s", self.camera_latency_s, kNonNegative,
          "latency from a frame's exposure to its arrival at the estimator");
    field("sensors", self.sensors, "tether encoders, IMU and initial height");
    field("station", self.station, "path of the ground station");
    field("sea", self.sea, "waves and drift under a station on a boat; null: station on land");
    field("wind", self.wind, "mean wind and gusts");
    field("yaw_kicks", self.yaw_kicks, "yaw disturbances; null: none");
    field("contrast_ratio", self.contrast_ratio, Range{0, 1},
          "contrast of the scene about grey 128; below 1: haze, with unchanged noise");
    field("moving_objects", self.moving_objects, "objects crossing the image; null: none");
    field("fault", self.fault, "temporary fault; null: none");
  }
};

}  // namespace stillkite
