#pragma once

#include "geometry/camera.hpp"

namespace stillkite {

/// Wide-angle drone camera with distortion, small for fast rendering.
[[nodiscard]] inline Camera small_camera() {
  return {.width_px = 400,
          .height_px = 240,
          .focal_x_px = 240,
          .focal_y_px = 240,
          .centre_x_px = 199.5,
          .centre_y_px = 119.5,
          .distortion = DistortionModel::radial_tangential,
          .coefficients = {-0.2, 0.04, 1e-4, -1e-4}};
}

}  // namespace stillkite
