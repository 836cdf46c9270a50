#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

// Axes of MAVLink: forward, right, down. Ours: forward, left, up. Both for the body and for the
// local world frame; y and z change their sign.

namespace stillkite::mavlink {

[[nodiscard]] inline Eigen::Vector3d flip_axes(const Eigen::Vector3d& v) {
  return {v.x(), -v.y(), -v.z()};
}

/// F R F with F = diag(1, -1, -1).
[[nodiscard]] inline Eigen::Quaterniond flip_axes(const Eigen::Quaterniond& q) {
  return {q.w(), q.x(), -q.y(), -q.z()};
}

/// F P F for each 3x3 block of a covariance.
[[nodiscard]] inline Eigen::Matrix<double, 6, 6> flip_axes(const Eigen::Matrix<double, 6, 6>& P) {
  const Eigen::Matrix<double, 6, 1> f{1, -1, -1, 1, -1, -1};
  return f.asDiagonal() * P * f.asDiagonal();
}

}  // namespace stillkite::mavlink
