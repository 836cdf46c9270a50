#include "geometry/euler.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stillkite {

EulerAngles to_euler(const Eigen::Quaterniond& world_from_body) {
  const Eigen::Matrix3d R = world_from_body.normalized().toRotationMatrix();
  const double cosine = std::hypot(R(0, 0), R(1, 0));
  const double pitch = std::atan2(-R(2, 0), cosine);
  if (cosine < 1e-9) return {std::atan2(-R(0, 1), R(1, 1)), pitch, 0.0};
  return {std::atan2(R(1, 0), R(0, 0)), pitch, std::atan2(R(2, 1), R(2, 2))};
}

Eigen::Quaterniond to_quaternion(const EulerAngles& angles) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  return AngleAxisd(angles.yaw_rad, Vector3d::UnitZ()) *
         AngleAxisd(angles.pitch_rad, Vector3d::UnitY()) *
         AngleAxisd(angles.roll_rad, Vector3d::UnitX());
}

EulerAngles attitude_of_up(const Eigen::Vector3d& up_in_body) {
  const Eigen::Vector3d up = up_in_body.normalized();  // of R = Rz Ry Rx: the last row
  return {.yaw_rad = 0,
          .pitch_rad = -std::asin(std::clamp(up.x(), -1.0, 1.0)),
          .roll_rad = std::atan2(up.y(), up.z())};
}

Eigen::Vector3d euler_rates(const EulerAngles& angles,
                            const Eigen::Vector3d& angular_rate_in_body_rad_s) {
  const Eigen::Vector3d& w = angular_rate_in_body_rad_s;
  const double sr = std::sin(angles.roll_rad);
  const double cr = std::cos(angles.roll_rad);
  const double cp = std::cos(angles.pitch_rad);
  const double tp = std::tan(angles.pitch_rad);
  const double across = sr * w.y() + cr * w.z();
  return {across / cp, cr * w.y() - sr * w.z(), w.x() + tp * across};
}

double wrap_angle_rad(double angle_rad) {
  constexpr double kFullCircle_rad = 2.0 * std::numbers::pi;
  const double wrapped = std::remainder(angle_rad, kFullCircle_rad);
  return wrapped <= -std::numbers::pi ? wrapped + kFullCircle_rad : wrapped;
}

double tilt_rad(const Eigen::Quaterniond& world_from_body) {
  const Eigen::Vector3d up_in_world = world_from_body * Eigen::Vector3d::UnitZ();
  return std::atan2(up_in_world.head<2>().norm(), up_in_world.z());
}

}  // namespace stillkite
