#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace stillkite {

/// ZYX angles of world_from_body: R = Rz(yaw) Ry(pitch) Rx(roll). With x forward, y left, z up a
/// positive pitch is nose down. Only for the edge (files, charts, the papers' own modes).
struct EulerAngles {
  double yaw_rad = 0;
  double pitch_rad = 0;
  double roll_rad = 0;
};

/// At pitch = +-90 deg yaw and roll are one angle: roll is then 0.
[[nodiscard]] EulerAngles to_euler(const Eigen::Quaterniond& world_from_body);

[[nodiscard]] Eigen::Quaterniond to_quaternion(const EulerAngles& angles);

/// Rates (yaw, pitch, roll) of the ZYX angles from the body's angular rate in the body frame.
/// Singular at pitch = +-90 deg.
[[nodiscard]] Eigen::Vector3d euler_rates(const EulerAngles& angles,
                                          const Eigen::Vector3d& angular_rate_in_body_rad_s);

/// The angle's representative in (-pi, pi].
[[nodiscard]] double wrap_angle_rad(double angle_rad);

/// Angle between the body's z axis and the world's, in [0, pi] rad.
[[nodiscard]] double tilt_rad(const Eigen::Quaterniond& world_from_body);

}  // namespace stillkite
