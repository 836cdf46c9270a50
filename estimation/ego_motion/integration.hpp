#pragma once

#include "estimation/twist.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// Euler integration of position and ZYX angles over one frame (flow paper, step 5):
///
///     X <- X + V dt + a dt^2 / 2,   angles <- angles + E(angles) (w + a_w dt / 2) dt.
///
/// E maps the body's angular rate to Euler angle rates; the paper sets E = I (exact at zero tilt).
/// `acceleration`: a(t) of the paper, linear in world (m/s^2), then angular in body (rad/s^2).
/// Singular at a pitch of +-90 deg.
[[nodiscard]] RigidTransform integrate_euler(const RigidTransform& world_from_body,
                                             const Eigen::Vector3d& velocity_in_world_m_s,
                                             const Eigen::Vector3d& angular_rate_in_body_rad_s,
                                             const Vector6d& acceleration, double dt_s);

/// Pose after a constant twist (v, w) over `dt_s`, in closed form:
/// R <- R exp(w dt), p <- p + R J(w dt) v dt, J the left Jacobian of SO(3).
[[nodiscard]] RigidTransform integrate_twist(const RigidTransform& world_from_camera,
                                             const Twist& twist_in_camera, double dt_s);

}  // namespace stillkite
