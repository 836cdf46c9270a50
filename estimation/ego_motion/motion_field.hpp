#pragma once

#include <Eigen/Core>

#include "geometry/camera.hpp"
#include "geometry/plane.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// d(x, y)/dt = M (v, w), linear in the camera's twist (both parts in the camera frame).
using MotionFieldMatrix = Eigen::Matrix<double, 2, 6>;

/// Motion of the image point b = (x, y) of the plane z = 1 whose inverse depth is rho (1/m):
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

/// The motion field of the ground at any attitude. At and above the horizon nothing but rotation
/// is seen: rho = 0 there.
[[nodiscard]] MotionFieldMatrix motion_field(const GroundPlane& ground,
                                             const Eigen::Vector2d& bearing);

/// The same in pixels per second, through the lens: J M with J = d(pixel)/d(x, y).
[[nodiscard]] MotionFieldMatrix motion_field_px(const Camera& camera, const GroundPlane& ground,
                                                const Eigen::Vector2d& bearing);

/// The matrices of the flow paper's equation (2),
///
///     d(x, y)/dt = D1 (V_x, V_y) + D2 w + D3 V_z,
///
/// V the camera's velocity in world axes, w its angular rate in the camera frame (the paper's
/// pitch, roll and yaw rates are these, turned by the camera's mount).
struct PaperMotionField {
  Eigen::Matrix2d D1;
  Eigen::Matrix<double, 2, 3> D2;
  Eigen::Vector2d D3;
};

/// Equation (2) at the paper's state: attitude and height out of world_from_camera.
[[nodiscard]] PaperMotionField paper_motion_field(const RigidTransform& world_from_camera,
                                                  const Eigen::Vector2d& bearing);

}  // namespace stillkite
