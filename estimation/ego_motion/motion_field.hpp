#pragma once

#include <Eigen/Core>

#include "geometry/camera.hpp"
#include "geometry/plane.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// Motion field M of d(x, y)/dt = M (v, w), the twist (v, w) in the camera frame.
using MotionFieldMatrix = Eigen::Matrix<double, 2, 6>;

/// Motion field at the image point (x, y) of the plane z = 1 with inverse depth rho (1/m):
///
///     dx/dt = rho (-v_x + x v_z) + x y w_x - (1 + x^2) w_y + y w_z
///     dy/dt = rho (-v_y + y v_z) + (1 + y^2) w_x - x y w_y - x w_z
[[nodiscard]] inline MotionFieldMatrix motion_field(const Eigen::Vector2d& bearing,
                                                    double inverse_depth) {
  const double x = bearing.x();
  const double y = bearing.y();
  const double rho = inverse_depth;
  MotionFieldMatrix m;
  m << -rho, 0, rho * x, x * y, -(1 + x * x), y,  //
      0, -rho, rho * y, 1 + y * y, -x * y, -x;
  return m;
}

/// Motion field of the ground plane at any attitude. At and above the horizon rho = 0: rotation
/// only.
[[nodiscard]] MotionFieldMatrix motion_field(const GroundPlane& ground,
                                             const Eigen::Vector2d& bearing);

/// Motion field in px/s, with lens distortion: J M, J = d(pixel)/d(x, y).
[[nodiscard]] MotionFieldMatrix motion_field_px(const Camera& camera, const GroundPlane& ground,
                                                const Eigen::Vector2d& bearing);

/// Matrices of the flow paper's equation (2),
///
///     d(x, y)/dt = D1 (V_x, V_y) + D2 w + D3 V_z,
///
/// V the camera's velocity in world, w its angular rate in camera (the paper's pitch, roll and yaw
/// rates, rotated by the camera mount).
struct PaperMotionField {
  Eigen::Matrix2d D1;
  Eigen::Matrix<double, 2, 3> D2;
  Eigen::Vector2d D3;
};

/// Equation (2) at the attitude and height of `world_from_camera`.
[[nodiscard]] PaperMotionField paper_motion_field(const RigidTransform& world_from_camera,
                                                  const Eigen::Vector2d& bearing);

}  // namespace stillkite
