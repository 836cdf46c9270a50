#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "geometry/camera.hpp"

namespace stillkite {

struct SampleCamera {
  std::string name;
  Camera camera;

  friend void PrintTo(const SampleCamera& sample, std::ostream* out) { *out << sample.name; }
};

/// One camera per lens model and number of coefficients.
[[nodiscard]] inline std::vector<SampleCamera> sample_cameras() {
  const auto camera = [](DistortionModel model, const std::array<double, 8>& coefficients) {
    return Camera{.width_px = 752,
                  .height_px = 480,
                  .focal_x_px = 458.654,
                  .focal_y_px = 457.296,
                  .centre_x_px = 367.215,
                  .centre_y_px = 248.375,
                  .distortion = model,
                  .coefficients = coefficients};
  };
  using enum DistortionModel;
  return {{"none", camera(none, {})},
          {"radtan4", camera(radial_tangential, {-0.2834, 0.0740, 1.94e-4, 1.76e-5})},
          {"radtan5", camera(radial_tangential, {-0.28, 0.09, -1e-3, 2e-3, -0.011})},
          {"radtan8", camera(radial_tangential, {0.8, 0.1, 1e-3, -8e-4, 2e-3, 1.1, 0.25, 0.01})},
          {"equidistant", camera(equidistant, {-0.0135, 0.0207, -0.0128, 0.0025})}};
}

/// Points of the plane z = 1 from the optical axis to approximately the image corners.
[[nodiscard]] inline std::vector<Eigen::Vector2d> points_in_view(const Camera& camera) {
  std::vector<Eigen::Vector2d> points = {{0, 0}, {1e-9, -1e-9}, {1e-7, 2e-7}, {0, 0.3}};
  const Eigen::Vector2d corner(0.5 * camera.width_px / camera.focal_x_px,
                               0.5 * camera.height_px / camera.focal_y_px);
  for (double x = -1; x <= 1; x += 0.125) {
    for (double y = -1; y <= 1; y += 0.125) {
      points.emplace_back(corner.x() * x, corner.y() * y);
    }
  }
  return points;
}

}  // namespace stillkite
