#pragma once

#include <Eigen/Core>
#include <random>
#include <vector>

#include "estimation/ego_motion/motion_field.hpp"
#include "estimation/twist.hpp"
#include "flow/flow_window.hpp"
#include "geometry/camera.hpp"
#include "geometry/euler.hpp"
#include "geometry/plane.hpp"

namespace stillkite::test {

/// A wide camera with a lens, looking down and a little aside from 12 m.
struct FlowScene {
  Camera camera{.width_px = 640,
                .height_px = 480,
                .focal_x_px = 420,
                .focal_y_px = 415,
                .centre_x_px = 318,
                .centre_y_px = 243,
                .distortion = DistortionModel::radial_tangential,
                .coefficients = {-0.12, 0.03, 0.001, -0.0005}};
  RigidTransform world_from_camera{
      to_quaternion({.yaw_rad = 0.4, .pitch_rad = 0.1, .roll_rad = 3.0}), {3, -2, 12}};
  Twist twist{{1.2, -0.7, 0.4}, {0.05, -0.08, 0.12}};
  double dt_s = 0.04;

  [[nodiscard]] GroundPlane ground() const { return ground_seen_from(world_from_camera); }

  /// The first-order flow of the twist on a grid.
  [[nodiscard]] std::vector<FlowWindow> flow(int step_px = 16) const {
    std::vector<FlowWindow> windows;
    for (int v = step_px / 2; v < camera.height_px; v += step_px) {
      for (int u = step_px / 2; u < camera.width_px; u += step_px) {
        const auto bearing = undistort(camera, Eigen::Vector2d(u, v));
        if (!bearing) continue;
        const Eigen::Vector2d flow_px =
            motion_field_px(camera, ground(), *bearing) * twist.vector() * dt_s;
        windows.push_back({Eigen::Vector2f(u, v), flow_px.cast<float>()});
      }
    }
    return windows;
  }
};

[[nodiscard]] inline Eigen::Vector3d random_vector(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> component(-size, size);
  return {component(random), component(random), component(random)};
}

/// Gaussian flow of the covariance that each window's information states, times sigma squared.
inline void add_noise(std::vector<FlowWindow>& windows, double sigma, std::mt19937& random) {
  std::normal_distribution<double> normal;
  for (FlowWindow& w : windows) {
    Eigen::Matrix2d G;
    G << w.information_xx, w.information_xy, w.information_xy, w.information_yy;
    const Eigen::Vector2d white(normal(random), normal(random));
    // G = L L^T, so L^-T white has covariance G^-1
    const Eigen::Matrix2d L = G.llt().matrixL();
    w.flow_px += (sigma * L.transpose().triangularView<Eigen::Upper>().solve(white)).cast<float>();
  }
}

}  // namespace stillkite::test
