#pragma once

#include <Eigen/Core>
#include <optional>

#include "estimation/fusion/error_state.hpp"
#include "estimation/fusion/fusion_state.hpp"

namespace stillkite {

/// d(Y_x / Y_z, Y_y / Y_z) / d(direction), with Y the direction (world axes) turned into the
/// camera.
[[nodiscard]] Eigen::Matrix<double, 2, 3> bearing_by_direction(
    const Eigen::Matrix3d& camera_from_world, const Eigen::Vector3d& Y);

/// Where the camera sees a point, on z = 1, and by how much that changes.
struct LandmarkProjection {
  Eigen::Vector2d bearing;
  Eigen::Matrix<double, 2, 3> by_direction;  ///< of Y below, world axes
  Eigen::Matrix<double, 2, 6> by_pose;       ///< the camera's rotation and position, world axes
  Eigen::Matrix<double, 2, 3> by_landmark;   ///< its bearing and inverse depth
};

/// With the anchor's pose (R_a, p_a), the camera's (R, p) and m = (bearing, 1),
///   Y = R^T (inverse_depth (p_a - p) + R_a m),   h = (Y_x, Y_y) / Y_z,
/// which stays defined at infinity (Civera, Davison, Montiel 2008, eq. (5)). Nothing where it is
/// not in front of the camera.
[[nodiscard]] std::optional<LandmarkProjection> project_landmark(
    const RigidTransform& world_from_camera, const RigidTransform& world_from_anchor,
    const Eigen::Vector2d& bearing, double inverse_depth);

/// Where a landmark is seen, compared with where it should be; both on z = 1 of the camera.
/// `column` is where the landmark's errors begin. Nothing where it is not in front of the camera.
[[nodiscard]] std::optional<Innovation<2>> landmark_innovation(const FusionState& state,
                                                               const Landmark& landmark, int column,
                                                               const Eigen::Vector2d& seen,
                                                               const Eigen::Matrix2d& covariance);

/// A landmark as it would be if the camera were its anchor.
struct LandmarkFromCamera {
  Eigen::Vector2d bearing;
  double inverse_depth = 0;
  SparseRows<1> by_error;  ///< d(inverse depth) / d(error)
};

/// With Y as above, its inverse depth from the camera is inverse_depth / Y_z. Nothing where it is
/// not in front of the camera.
[[nodiscard]] std::optional<LandmarkFromCamera> landmark_from_camera(const FusionState& state,
                                                                     const Landmark& landmark,
                                                                     int column);

/// Covariance, on z = 1, of what the linear update leaves out of a view: the product of the errors
/// of the way p_a - p (map units, world axes) and of the inverse depth.
[[nodiscard]] Eigen::Matrix2d product_covariance(const FusionState& state, const Landmark& landmark,
                                                 const Eigen::Matrix3d& displacement_covariance,
                                                 double inverse_depth_variance);

}  // namespace stillkite
