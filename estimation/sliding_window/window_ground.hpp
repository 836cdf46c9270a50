#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "estimation/sliding_window/reprojection_factor.hpp"

namespace stillkite {

/// Plane of the ground in the world: z = height + slope . (x, y).
struct WindowGround {
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  double height_m = 0;
};

/// Order of the error of a WindowGround, additive.
struct GroundIndex {
  static constexpr int kSlope = 0;
  static constexpr int kHeight = 2;
  static constexpr int kSize = 3;
};
using GroundError = Eigen::Matrix<double, GroundIndex::kSize, 1>;

/// `plane` plus an error.
[[nodiscard]] WindowGround plus(const WindowGround& plane, const GroundError& error);
/// Error of `from` relative to `to`.
[[nodiscard]] GroundError minus(const WindowGround& to, const WindowGround& from);

/// Ground in the axes of a camera. A point is (normal . (bearing, 1) / inverse depth + height)
/// above it, vertically.
struct GroundView {
  Eigen::Vector3d normal;  ///< its vertical component is 1
  double height_m = 0;     ///< of the camera above the ground

  /// Height of a point above the ground, over its depth.
  [[nodiscard]] double height_ratio(const InverseDepthPoint& point) const {
    return normal.dot(point.bearing.homogeneous()) + point.inverse_depth * height_m;
  }
};
[[nodiscard]] GroundView ground_view(const WindowGround& plane,
                                     const RigidTransform& world_from_imu,
                                     const RigidTransform& imu_from_camera);

/// Error (normal, height) of a GroundView by the errors of the IMU's pose (order of InertialIndex),
/// of the camera's mount (order of ExtrinsicsIndex) and of the plane.
struct GroundViewJacobians {
  Eigen::Matrix<double, 4, 6> by_pose;
  Eigen::Matrix<double, 4, 6> by_extrinsics;
  Eigen::Matrix<double, 4, GroundIndex::kSize> by_plane;
};
[[nodiscard]] GroundViewJacobians ground_view_jacobians(const WindowGround& plane,
                                                        const RigidTransform& world_from_imu,
                                                        const RigidTransform& imu_from_camera);

/// Point of the ground on a ray of the camera; empty at the horizon and above.
[[nodiscard]] std::optional<InverseDepthPoint> point_on_ground(const GroundView& view,
                                                               const Eigen::Vector2d& bearing);

}  // namespace stillkite
