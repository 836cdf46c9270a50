#pragma once

#include <Eigen/Core>
#include <optional>

#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// Residual of a measured bearing, z - h, with the Jacobians of h; errors in world axes,
/// R_true = exp(e_R) R, p_true = p + e_p.
struct KnownLandmarkView {
  Eigen::Vector2d residual;
  Eigen::Matrix<double, 2, 6> by_pose;      ///< of the camera: rotation, position
  Eigen::Matrix<double, 2, 3> by_landmark;  ///< position in world
};

/// Bearing z (x, y on z = 1) of the camera (R, p) to a landmark whose position l a map gives:
///   Y = R^T (l - p),   h = (Y_x, Y_y) / Y_z
///   J = dh/dY R^T,     dh/de_R = J [l - p]x,   dh/de_p = -J,   dh/dl = J
/// The map's error of l is the same in every view: it belongs into the state, not into the noise
/// of z (docs/fusion.md). nullopt if the landmark is not in front of the camera.
[[nodiscard]] std::optional<KnownLandmarkView> known_landmark_view(
    const RigidTransform& world_from_camera, const Eigen::Vector3d& landmark_in_world_m,
    const Eigen::Vector2d& bearing);

}  // namespace stillkite
