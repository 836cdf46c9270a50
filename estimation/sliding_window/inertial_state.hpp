#pragma once

#include <Eigen/Core>

#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// State of the IMU at one time. World W: z up against gravity.
struct InertialState {
  RigidTransform world_from_imu;  ///< m
  Eigen::Vector3d velocity_in_world_m_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d gyro_bias_rad_s = Eigen::Vector3d::Zero();  ///< IMU axes
  Eigen::Vector3d accel_bias_m_s2 = Eigen::Vector3d::Zero();  ///< IMU axes
};

/// Order of an InertialState's error: R_true = R exp(rotation), rotation in IMU axes; the rest is
/// additive. The first six components are the pose.
struct InertialIndex {
  static constexpr int kRotation = 0;
  static constexpr int kPosition = 3;
  static constexpr int kPoseSize = 6;
  static constexpr int kVelocity = 6;
  static constexpr int kGyroBias = 9;
  static constexpr int kAccelBias = 12;
  static constexpr int kSize = 15;
};
using InertialError = Eigen::Matrix<double, InertialIndex::kSize, 1>;

/// `state` plus an error.
[[nodiscard]] InertialState plus(const InertialState& state, const InertialError& error);

/// Error of `from` relative to `to`: plus(from, minus(to, from)) == to.
[[nodiscard]] InertialError minus(const InertialState& to, const InertialState& from);

}  // namespace stillkite
