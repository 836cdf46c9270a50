#pragma once

#include <Eigen/Core>
#include <random>
#include <vector>

#include "estimation/ego_motion/motion_field.hpp"
#include "estimation/twist.hpp"
#include "flow/flow_vector.hpp"
#include "geometry/camera.hpp"
#include "geometry/euler.hpp"
#include "geometry/plane.hpp"

namespace stillkite::test {

/// Wide-angle camera with lens distortion at 12 m, tilted from nadir.
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

  [[nodiscard]] GroundPlane ground() const { return ground_plane_in_camera(world_from_camera); }

  /// First-order flow of the twist on a pixel grid.
  [[nodiscard]] std::vector<FlowVector> flow(int step_px = 16) const {
    std::vector<FlowVector> vectors;
    for (int v = step_px / 2; v < camera.height_px; v += step_px) {
      for (int u = step_px / 2; u < camera.width_px; u += step_px) {
        const auto bearing = undistort(camera, Eigen::Vector2d(u, v));
        if (!bearing) continue;
        const Eigen::Vector2d flow_px =
            motion_field_px(camera, ground(), *bearing) * twist.vector() * dt_s;
        vectors.push_back({Eigen::Vector2f(u, v), flow_px.cast<float>()});
      }
    }
    return vectors;
  }
};

/// Uniform in [-size, size]^3.
[[nodiscard]] inline Eigen::Vector3d random_vector(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> component(-size, size);
  return {component(random), component(random), component(random)};
}

/// Adds Gaussian noise of covariance sigma^2 G^-1, G the information matrix of the vector.
inline void add_noise(std::vector<FlowVector>& vectors, double sigma, std::mt19937& random) {
  std::normal_distribution<double> normal;
  for (FlowVector& vector : vectors) {
    Eigen::Matrix2d G;
    G << vector.information_xx, vector.information_xy, vector.information_xy, vector.information_yy;
    const Eigen::Vector2d white(normal(random), normal(random));
    // G = L L^T, so L^-T white has covariance G^-1
    const Eigen::Matrix2d L = G.llt().matrixL();
    vector.flow_px +=
        (sigma * L.transpose().triangularView<Eigen::Upper>().solve(white)).cast<float>();
  }
}

}  // namespace stillkite::test
