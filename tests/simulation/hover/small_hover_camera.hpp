#pragma once

#include "simulation/hover/plant_config.hpp"

namespace stillkite {

/// Trial camera with reduced resolution and frame rate, same field of view and aspect ratio of 5:3.
[[nodiscard]] inline SimulatedCameraConfig small_hover_camera(int width_px, double frames_per_s) {
  SimulatedCameraConfig camera = hover_camera();
  camera.width_px = width_px;
  camera.height_px = width_px * 3 / 5;
  camera.focal_x_px = camera.focal_y_px = 0.6 * width_px;
  camera.centre_x_px = 0.5 * (camera.width_px - 1);
  camera.centre_y_px = 0.5 * (camera.height_px - 1);
  camera.frames_per_s = frames_per_s;
  return camera;
}

}  // namespace stillkite
