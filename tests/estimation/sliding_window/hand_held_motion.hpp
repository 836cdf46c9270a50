#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <random>
#include <span>
#include <vector>

#include "estimation/sliding_window/sliding_window.hpp"

// Smooth analytic motion of an IMU and a camera in front of random points, with known biases.

namespace stillkite {

struct HandHeldMotion {
  double amplitude_m = 0.4;
  double tilt_rad = 0.15;
  Eigen::Vector3d gyro_bias_rad_s{-0.003, 0.021, 0.079};
  Eigen::Vector3d accel_bias_m_s2{0.03, -0.05, 0.04};
  CameraExtrinsics extrinsics{
      .imu_from_camera = {
          Eigen::Quaterniond(Eigen::AngleAxisd(2.2, Eigen::Vector3d(1, 0.3, -0.2).normalized())),
          Eigen::Vector3d(-0.02, -0.06, 0.01)}};

  [[nodiscard]] InertialState state(double t_s) const;
  [[nodiscard]] Eigen::Vector3d angular_rate(double t_s) const;    ///< true, IMU axes
  [[nodiscard]] Eigen::Vector3d specific_force(double t_s) const;  ///< true, IMU axes
  /// Mean readings of 200 Hz over (from, to], with white noise of the densities.
  [[nodiscard]] std::vector<ImuSample> samples(double from_s, double to_s, const ImuNoise& noise,
                                               std::mt19937& random) const;
  /// The same with their times.
  [[nodiscard]] std::vector<ImuInterval> readings(double from_s, double to_s, const ImuNoise& noise,
                                                  std::mt19937& random) const;
};

/// Points in view of the camera at the motion's start, 2 to 8 m away.
[[nodiscard]] std::vector<Eigen::Vector3d> points_in_view(const HandHeldMotion& motion, int count,
                                                          std::mt19937& random);

/// Bearings of the points at a time, with noise; numbered in their order. Points outside the field
/// of view are left out.
[[nodiscard]] std::vector<FeatureObservation> observe(const HandHeldMotion& motion, double t_s,
                                                      std::span<const Eigen::Vector3d> points,
                                                      double sigma, std::mt19937& random);

}  // namespace stillkite
