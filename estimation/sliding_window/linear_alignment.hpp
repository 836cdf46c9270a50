#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "estimation/sliding_window/window.hpp"

namespace stillkite {

/// Solution of the linear equations of gravity, velocity and depths (Dong-Si and Mourikis 2012),
/// in the axes of the first frame's IMU.
struct LinearAlignment {
  Eigen::Vector3d gravity;
  Eigen::Vector3d velocity;
  std::vector<RigidTransform> first_from_imu;   ///< of each frame
  std::vector<Eigen::Vector3d> velocities;      ///< of each frame
  std::vector<std::optional<double>> depths_m;  ///< of each track in its first keyframe
};
[[nodiscard]] std::optional<LinearAlignment> align_linearly(const Window& window);

}  // namespace stillkite
