#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace stillkite {

/// Kalman filter of a gyroscope's bias, a random walk, measured by the rotation between two images.
/// All vectors in camera axes.
class GyroBias {
 public:
  /// Zero bias with this standard deviation per axis.
  explicit GyroBias(double sigma_rad_s);

  /// Integrates a mean angular rate over an interval; its noise has the standard deviation
  /// `sigma_rad_s`.
  void integrate(const Eigen::Vector3d& mean_rate_rad_s, double dt_s, double sigma_rad_s);

  /// Starts the integration at an image with this rotation to a common reference, `covariance` of
  /// its rotation vector.
  void start_at(const Eigen::Quaterniond& reference_from_camera, const Eigen::Matrix3d& covariance);

  /// Discards the interval since that image: a rate is missing.
  void stop() { duration_s_ = -1; }

  /// Updates by an image with this rotation to the same reference, once the interval is long enough
  /// to measure the bias; starts the next interval at it.
  void update(const Eigen::Quaterniond& reference_from_camera, const Eigen::Matrix3d& covariance);

  [[nodiscard]] const Eigen::Vector3d& mean_rad_s() const { return mean_rad_s_; }
  [[nodiscard]] const Eigen::Matrix3d& covariance() const { return covariance_; }

 private:
  Eigen::Vector3d mean_rad_s_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_;
  // since the image at which the integration started
  Eigen::Quaterniond initial_from_reference_ = Eigen::Quaterniond::Identity();
  Eigen::Matrix3d initial_covariance_ = Eigen::Matrix3d::Zero();
  Eigen::Quaterniond initial_from_camera_ = Eigen::Quaterniond::Identity();  // by the gyroscope
  double noise_variance_ = 0;                                                // of that rotation
  double duration_s_ = -1;  // negative: not started
};

}  // namespace stillkite
