#include "estimation/ego_motion/integration.hpp"

#include "geometry/euler.hpp"

namespace stillkite {

RigidTransform integrate_euler(const RigidTransform& world_from_body,
                               const Eigen::Vector3d& velocity_in_world_m_s,
                               const Eigen::Vector3d& angular_rate_in_body_rad_s,
                               const Vector6d& acceleration, double dt_s) {
  const EulerAngles angles = to_euler(world_from_body.rotation);
  const Eigen::Vector3d mean_rate =
      angular_rate_in_body_rad_s + 0.5 * dt_s * acceleration.tail<3>();
  const Eigen::Vector3d rates = euler_rates(angles, mean_rate);
  const Eigen::Vector3d mean_velocity = velocity_in_world_m_s + 0.5 * dt_s * acceleration.head<3>();
  return {to_quaternion({.yaw_rad = angles.yaw_rad + rates(0) * dt_s,
                         .pitch_rad = angles.pitch_rad + rates(1) * dt_s,
                         .roll_rad = angles.roll_rad + rates(2) * dt_s}),
          world_from_body.translation + mean_velocity * dt_s};
}

RigidTransform integrate_twist(const RigidTransform& world_from_camera,
                               const Twist& twist_in_camera, double dt_s) {
  const Eigen::Vector3d rotation_vector = twist_in_camera.angular_rate_rad_s * dt_s;
  const Eigen::Vector3d displacement =
      so3_left_jacobian(rotation_vector) * twist_in_camera.velocity_m_s * dt_s;
  return world_from_camera * RigidTransform{so3_exp(rotation_vector), displacement};
}

}  // namespace stillkite
