#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

// Axes of autopilots: body FRD (x forward, y right, z down), world NED (north, east, down).

namespace stillkite {

/// Vector in FRD to x forward, y left, z up.
[[nodiscard]] inline Eigen::Vector3d flu_from_frd(const Eigen::Vector3d& v) {
  return {v.x(), -v.y(), -v.z()};
}

/// Vector in NED to x east, y north, z up.
[[nodiscard]] inline Eigen::Vector3d enu_from_ned(const Eigen::Vector3d& v) {
  return {v.y(), v.x(), -v.z()};
}

/// Attitude ned_from_frd to enu_from_flu.
[[nodiscard]] inline Eigen::Quaterniond enu_from_flu(const Eigen::Quaterniond& ned_from_frd) {
  const Eigen::Quaterniond enu_from_ned(0, M_SQRT1_2, M_SQRT1_2, 0);
  const Eigen::Quaterniond frd_from_flu(0, 1, 0, 0);
  return enu_from_ned * ned_from_frd * frd_from_flu;
}

/// Attitude enu_from_flu of the autopilot's Euler angles: R = Rz(yaw) Ry(pitch) Rx(roll) in NED.
[[nodiscard]] inline Eigen::Quaterniond enu_from_flu(double roll_rad, double pitch_rad,
                                                     double yaw_rad) {
  const Eigen::Quaterniond ned_from_frd = Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()) *
                                          Eigen::AngleAxisd(pitch_rad, Eigen::Vector3d::UnitY()) *
                                          Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitX());
  return enu_from_flu(ned_from_frd);
}

}  // namespace stillkite
