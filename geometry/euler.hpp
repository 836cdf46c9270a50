#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace stillkite {

/// ZYX Euler angles of world_from_body: R = Rz(yaw) Ry(pitch) Rx(roll). Body axes x forward, y
/// left, z up: positive pitch is nose down. For files, charts and the papers' own modes only.
struct EulerAngles {
  double yaw_rad = 0;
  double pitch_rad = 0;
  double roll_rad = 0;
};

/// Gimbal lock (pitch = +-90 deg): roll is set to 0.
[[nodiscard]] EulerAngles to_euler(const Eigen::Quaterniond& world_from_body);

[[nodiscard]] Eigen::Quaterniond to_quaternion(const EulerAngles& angles);

/// Roll and pitch of a body in which the world's z axis has the direction `up_in_body`, not zero;
/// yaw 0.
[[nodiscard]] EulerAngles attitude_of_up(const Eigen::Vector3d& up_in_body);

/// Rates (yaw, pitch, roll) of the ZYX angles from the angular rate in the body frame, rad/s.
/// Singular at pitch = +-90 deg.
[[nodiscard]] Eigen::Vector3d euler_rates(const EulerAngles& angles,
                                          const Eigen::Vector3d& angular_rate_in_body_rad_s);

/// Equivalent angle in (-pi, pi].
[[nodiscard]] double wrap_angle_rad(double angle_rad);

/// Angle between the z axes of body and world, in [0, pi] rad.
[[nodiscard]] double tilt_rad(const Eigen::Quaterniond& world_from_body);

}  // namespace stillkite
