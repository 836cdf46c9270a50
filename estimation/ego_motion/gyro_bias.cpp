#include "estimation/ego_motion/gyro_bias.hpp"

#include <Eigen/Cholesky>

#include "geometry/rigid_transform.hpp"

namespace stillkite {
namespace {

// Long enough for a rotation of 1 mrad to measure 2 mrad/s, short enough for any flight.
constexpr double kMinDuration_s = 0.5;

// Random walk of a MEMS gyroscope's bias with temperature, rad/s/sqrt(s).
constexpr double kWalk = 1e-4;

}  // namespace

GyroBias::GyroBias(double sigma_rad_s)
    : covariance_(sigma_rad_s * sigma_rad_s * Eigen::Matrix3d::Identity()) {}

void GyroBias::integrate(const Eigen::Vector3d& mean_rate_rad_s, double dt_s, double sigma_rad_s) {
  covariance_.diagonal().array() += kWalk * kWalk * dt_s;
  if (duration_s_ < 0) return;
  initial_from_camera_ = (initial_from_camera_ * so3_exp(mean_rate_rad_s * dt_s)).normalized();
  noise_variance_ += sigma_rad_s * sigma_rad_s * dt_s * dt_s;
  duration_s_ += dt_s;
}

void GyroBias::start_at(const Eigen::Quaterniond& reference_from_camera,
                        const Eigen::Matrix3d& covariance) {
  initial_from_reference_ = reference_from_camera.conjugate();
  initial_covariance_ = covariance;
  initial_from_camera_ = Eigen::Quaterniond::Identity();
  noise_variance_ = 0;
  duration_s_ = 0;
}

void GyroBias::update(const Eigen::Quaterniond& reference_from_camera,
                      const Eigen::Matrix3d& covariance) {
  if (duration_s_ >= 0 && duration_s_ < kMinDuration_s) return;
  if (duration_s_ >= 0) {
    const Eigen::Quaterniond initial_from_camera = initial_from_reference_ * reference_from_camera;
    const Eigen::Vector3d measured_rad_s =
        so3_log(initial_from_camera.conjugate() * initial_from_camera_) / duration_s_;
    const Eigen::Matrix3d noise =
        (initial_covariance_ + covariance + noise_variance_ * Eigen::Matrix3d::Identity()) /
        (duration_s_ * duration_s_);
    const Eigen::Matrix3d gain = (covariance_ + noise).ldlt().solve(covariance_).transpose();
    mean_rad_s_ += gain * (measured_rad_s - mean_rad_s_);
    const Eigen::Matrix3d I_K = Eigen::Matrix3d::Identity() - gain;
    covariance_ = I_K * covariance_ * I_K.transpose() + gain * noise * gain.transpose();
  }
  start_at(reference_from_camera, covariance);
}

}  // namespace stillkite
