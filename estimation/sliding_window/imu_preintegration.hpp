#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "estimation/sliding_window/inertial_state.hpp"

namespace stillkite {

/// Noise of an IMU, from its data sheet.
struct ImuNoise {
  double gyro_density = 5e-4;     ///< white noise, rad/s/sqrt(Hz)
  double accel_density = 0.01;    ///< white noise, m/s^2/sqrt(Hz)
  double gyro_bias_walk = 5e-5;   ///< rad/s^2/sqrt(Hz)
  double accel_bias_walk = 3e-3;  ///< m/s^3/sqrt(Hz)
};

/// Mean readings of an IMU over a time step. Gap: the readings before it are held, with the sigma
/// of a motion that is not measured.
struct ImuSample {
  double dt_s = 0;
  Eigen::Vector3d angular_rate_rad_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d specific_force_m_s2 = Eigen::Vector3d::Zero();
  bool is_gap = false;
};

/// Order of the error of a preintegrated motion: rotation in the last IMU's axes, velocity and
/// position change in the first one's.
struct ImuMotionIndex {
  static constexpr int kRotation = 0;
  static constexpr int kVelocity = 3;
  static constexpr int kPosition = 6;
  static constexpr int kSize = 9;
};

/// Motion between two states by IMU readings, independent of the states (Forster et al.,
/// "On-manifold preintegration for real-time visual-inertial odometry", IEEE T-RO 2017). Gravity is
/// excluded.
class ImuPreintegration {
 public:
  using Matrix9d = Eigen::Matrix<double, 9, 9>;

  explicit ImuPreintegration(const ImuNoise& noise = {}) : noise_(noise) {}

  /// Appends a sample; dt > 0.
  void add(const ImuSample& sample);
  /// Appends the samples of the interval that follows.
  void append(const ImuPreintegration& next);
  /// Integrates all samples again about other biases, where the first-order correction is exact.
  void reintegrate(const Eigen::Vector3d& gyro_bias_rad_s, const Eigen::Vector3d& accel_bias_m_s2);

  [[nodiscard]] double duration_s() const { return duration_s_; }
  [[nodiscard]] const std::vector<ImuSample>& samples() const { return samples_; }
  [[nodiscard]] const ImuNoise& noise() const { return noise_; }
  [[nodiscard]] const Eigen::Vector3d& gyro_bias_rad_s() const { return gyro_bias_rad_s_; }
  [[nodiscard]] const Eigen::Vector3d& accel_bias_m_s2() const { return accel_bias_m_s2_; }

  /// Motion at other biases, first order: rotation (first IMU from last), velocity and position
  /// change in the first IMU's axes (Forster et al., eq. 44).
  struct Motion {
    Eigen::Quaterniond rotation;
    Eigen::Vector3d velocity;
    Eigen::Vector3d position;
  };
  [[nodiscard]] Motion motion(const Eigen::Vector3d& gyro_bias_rad_s,
                              const Eigen::Vector3d& accel_bias_m_s2) const;

  /// State at the end from the state at the start.
  [[nodiscard]] InertialState predict(const InertialState& start) const;

  /// Order of ImuMotionIndex.
  [[nodiscard]] const Matrix9d& covariance() const { return covariance_; }
  /// Jacobian of the motion with respect to (gyro bias, accelerometer bias).
  [[nodiscard]] const Eigen::Matrix<double, 9, 6>& bias_jacobian() const { return bias_jacobian_; }

 private:
  void integrate(const ImuSample& sample);

  ImuNoise noise_;
  std::vector<ImuSample> samples_;
  double duration_s_ = 0;
  Eigen::Vector3d gyro_bias_rad_s_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel_bias_m_s2_ = Eigen::Vector3d::Zero();
  Motion motion_{Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  Matrix9d covariance_ = Matrix9d::Zero();
  Eigen::Matrix<double, 9, 6> bias_jacobian_ = Eigen::Matrix<double, 9, 6>::Zero();
};

/// Gravity in the world, m/s^2.
[[nodiscard]] Eigen::Vector3d gravity_in_world();

}  // namespace stillkite
