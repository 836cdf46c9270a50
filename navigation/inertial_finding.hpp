#pragma once

#include <Eigen/Core>

namespace stillkite {

/// Differences of IMU and mount from their calibration.
enum class InertialFault {
  clock,            ///< offset between IMU and images
  camera_rotation,  ///< relative to the IMU
  lever_arm,        ///< camera's position in the IMU's axes
  accelerometer,    ///< bias beyond the prior: scale, axes, units or a damaged sensor
  axes,             ///< camera rotation beyond its prior: axes of the IMU, or the mount
  contradiction,    ///< no motion explains both images and IMU
};

/// A difference of more than five standard deviations.
struct InertialFinding {
  InertialFault fault;
  Eigen::Vector3d value = Eigen::Vector3d::Zero();   ///< estimate: s (x), rad, m or m/s^2
  Eigen::Vector3d change = Eigen::Vector3d::Zero();  ///< of the calibration
  Eigen::Vector3d sigma = Eigen::Vector3d::Zero();
};

}  // namespace stillkite
