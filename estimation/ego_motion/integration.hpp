#pragma once

#include "estimation/twist.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// Step 5 of the flow paper's procedure: one Euler step of position and ZYX angles,
///
///     X <- X + V dt + a dt^2 / 2,   angles <- angles + E(angles) (w + a_w dt / 2) dt,
///
/// E turns the body's angular rate into the angles' rates, which the paper takes as equal (they
/// are at zero tilt). `acceleration`: the paper's a(t), linear in the world (m/s^2), then angular
/// in the body (rad/s^2). Singular at a pitch of +-90 deg.
[[nodiscard]] RigidTransform integrate_euler(const RigidTransform& world_from_body,
                                             const Eigen::Vector3d& velocity_in_world_m_s,
                                             const Eigen::Vector3d& angular_rate_in_body_rad_s,
                                             const Vector6d& acceleration, double dt_s);

/// The pose after a step of constant twist, in closed form: with the camera's v and w,
/// R <- R exp(w dt), p <- p + R J(w dt) v dt, J the left Jacobian of SO(3).
[[nodiscard]] RigidTransform integrate_twist(const RigidTransform& world_from_camera,
                                             const Twist& twist_in_camera, double dt_s);

}  // namespace stillkite
