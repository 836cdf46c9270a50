#pragma once

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "calibration/board_view.hpp"
#include "geometry/camera.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// Views of a 9 x 6 grid of corners 30 mm apart, tilted by up to 45 degrees, with Gaussian noise.
[[nodiscard]] inline std::vector<BoardView> synthetic_views(const Camera& camera, int count,
                                                            double sigma_px, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, sigma_px);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  std::vector<BoardView> views;
  while (static_cast<int>(views.size()) < count) {
    const auto ray =
        undistort(camera, {uniform(0, 1) * camera.width_px, uniform(0, 1) * camera.height_px});
    if (!ray) continue;
    const double azimuth = uniform(-std::numbers::pi, std::numbers::pi);
    const Eigen::Vector3d tilt_rad =
        uniform(0, 0.8) * Eigen::Vector3d(std::cos(azimuth), std::sin(azimuth), 0);
    const RigidTransform camera_from_board{so3_exp({0, 0, uniform(-3, 3)}) * so3_exp(tilt_rad),
                                           uniform(0.3, 0.6) * ray->homogeneous().normalized()};
    BoardView view;
    view.stamp = from_seconds(static_cast<double>(views.size()));
    for (int id = 0; id < 54; ++id) {
      const Eigen::Vector2d corner_m = 0.03 * Eigen::Vector2d(id % 9 - 4, id / 9 - 2.5);
      const auto pixel =
          project(camera, camera_from_board * Eigen::Vector3d(corner_m.x(), corner_m.y(), 0));
      if (!pixel || pixel->x() < 0 || pixel->y() < 0 || pixel->x() > camera.width_px - 1 ||
          pixel->y() > camera.height_px - 1) {
        continue;
      }
      view.ids.push_back(id);
      view.corners_m.push_back(corner_m);
      view.pixels.push_back(*pixel + Eigen::Vector2d(noise(random), noise(random)));
    }
    if (view.ids.size() >= 20) views.push_back(view);
  }
  return views;
}

}  // namespace stillkite
