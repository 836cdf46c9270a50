#pragma once

#include <Eigen/Core>
#include <optional>

#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// Camera relative to the IMU, and its clock.
struct CameraExtrinsics {
  RigidTransform imu_from_camera;  ///< rotation and lever arm, m
  double time_offset_s = 0;        ///< IMU time of an image minus its stamp
};

/// Order of the error of CameraExtrinsics: R_true = R exp(rotation); the rest is additive.
struct ExtrinsicsIndex {
  static constexpr int kRotation = 0;
  static constexpr int kLeverArm = 3;
  static constexpr int kTimeOffset = 6;
  static constexpr int kSize = 7;
};
using ExtrinsicsError = Eigen::Matrix<double, ExtrinsicsIndex::kSize, 1>;

/// `extrinsics` plus an error.
[[nodiscard]] CameraExtrinsics plus(const CameraExtrinsics& extrinsics,
                                    const ExtrinsicsError& error);
/// Error of `from` relative to `to`.
[[nodiscard]] ExtrinsicsError minus(const CameraExtrinsics& to, const CameraExtrinsics& from);

/// Point in its first keyframe's camera: (bearing, 1) / inverse depth.
struct InverseDepthPoint {
  Eigen::Vector2d bearing = Eigen::Vector2d::Zero();  ///< on z = 1
  double inverse_depth = 0;                           ///< 1/m
};

/// Camera of an image relative to the camera of a point's first keyframe, the host.
struct CameraPair {
  Eigen::Matrix3d camera_from_imu;
  Eigen::Matrix3d camera_from_world;     ///< the other camera's rotation
  Eigen::Matrix3d camera_from_host_imu;  ///< rotation
  Eigen::Matrix3d camera_from_host;      ///< rotation from the host camera
  Eigen::Vector3d baseline_m;            ///< origin of the host camera
  Eigen::Vector3d lever_arm_m;
};
[[nodiscard]] CameraPair camera_pair(const RigidTransform& world_from_host,
                                     const RigidTransform& world_from_target,
                                     const RigidTransform& imu_from_camera);

/// Error (rotation r, baseline b) of a camera pair: y + r x y + inverse depth * b, y the point in
/// the other camera over its depth in the host camera.
using PairError = Vector6d;

/// Error of a camera pair by the errors of the IMU's poses (order of InertialIndex), and of
/// rotation and lever arm of the camera.
struct PairJacobians {
  Matrix6d by_host;
  Matrix6d by_target;
  Matrix6d by_extrinsics;
};
[[nodiscard]] PairJacobians pair_jacobians(const CameraPair& pair);

/// Projection of a point to z = 1 of the other camera, with Jacobians.
struct PointProjection {
  Eigen::Vector2d bearing;
  Eigen::Matrix<double, 2, 6> by_pair;   ///< PairError
  Eigen::Matrix<double, 2, 3> by_point;  ///< bearing and inverse depth
};

/// Empty if the point is behind the camera.
[[nodiscard]] std::optional<PointProjection> project_point(const CameraPair& pair,
                                                           const InverseDepthPoint& point);
/// Bearing only, without Jacobians.
[[nodiscard]] std::optional<Eigen::Vector2d> project_bearing(const CameraPair& pair,
                                                             const InverseDepthPoint& point);

}  // namespace stillkite
