#pragma once

#include <Eigen/Core>

#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// Ground plane in the camera frame: points X with normal . X = height.
struct GroundPlane {
  Eigen::Vector3d normal_in_camera;  ///< unit vector from the camera towards the ground
  double height_m = 0;               ///< of the camera over the ground, > 0
};

/// Ground plane z = 0 of the world: normal = -R^T e_z, R = world_from_camera (flow paper, Fig. 1).
[[nodiscard]] inline GroundPlane ground_plane_in_camera(const RigidTransform& world_from_camera) {
  return {-(world_from_camera.rotation.conjugate() * Eigen::Vector3d::UnitZ()),
          world_from_camera.translation.z()};
}

/// Inverse depth rho = n.b / h of the ground along the bearing b = (x, y, 1), 1/m; <= 0 at and
/// above the horizon.
[[nodiscard]] inline double inverse_depth(const GroundPlane& ground,
                                          const Eigen::Vector2d& bearing) {
  return ground.normal_in_camera.dot(bearing.homogeneous()) / ground.height_m;
}

}  // namespace stillkite
