#include "estimation/sliding_window/imu_preintegration.hpp"

#include "geometry/gravity.hpp"

namespace stillkite {
namespace {

// Motion during a gap, per axis: a drone's rates and accelerations.
constexpr double kGapRate_rad_s = 1;
constexpr double kGapForce_m_s2 = 5;

}  // namespace

void ImuPreintegration::add(const ImuSample& sample) {
  samples_.push_back(sample);
  integrate(sample);
}

void ImuPreintegration::append(const ImuPreintegration& next) {
  for (const ImuSample& sample : next.samples_) add(sample);
}

void ImuPreintegration::reintegrate(const Eigen::Vector3d& gyro_bias_rad_s,
                                    const Eigen::Vector3d& accel_bias_m_s2) {
  duration_s_ = 0;
  gyro_bias_rad_s_ = gyro_bias_rad_s;
  accel_bias_m_s2_ = accel_bias_m_s2;
  motion_ = {Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  covariance_.setZero();
  bias_jacobian_.setZero();
  for (const ImuSample& sample : samples_) integrate(sample);
}

// Rotation at mid-step for the specific force: second order in the time step.
void ImuPreintegration::integrate(const ImuSample& sample) {
  const double dt = sample.dt_s;
  const Eigen::Vector3d step_rad = dt * (sample.angular_rate_rad_s - gyro_bias_rad_s_);
  const Eigen::Vector3d force = sample.specific_force_m_s2 - accel_bias_m_s2_;
  const Eigen::Matrix3d middle = (motion_.rotation * so3_exp(0.5 * step_rad)).toRotationMatrix();
  const Eigen::Matrix3d step_inverse = so3_exp(-step_rad).toRotationMatrix();
  const Eigen::Matrix3d right_jacobian = so3_left_jacobian(-step_rad);

  // d(new) = A d(old) + B d(bias), to second order in the step
  const Eigen::Matrix3d by_rotation =
      -middle * skew(force) * so3_exp(-0.5 * step_rad).toRotationMatrix();
  Matrix9d A = Matrix9d::Identity();
  A.block<3, 3>(ImuMotionIndex::kRotation, ImuMotionIndex::kRotation) = step_inverse;
  A.block<3, 3>(ImuMotionIndex::kVelocity, ImuMotionIndex::kRotation) = dt * by_rotation;
  A.block<3, 3>(ImuMotionIndex::kPosition, ImuMotionIndex::kRotation) = 0.5 * dt * dt * by_rotation;
  A.block<3, 3>(ImuMotionIndex::kPosition, ImuMotionIndex::kVelocity) =
      dt * Eigen::Matrix3d::Identity();
  Eigen::Matrix<double, 9, 6> B = Eigen::Matrix<double, 9, 6>::Zero();
  const Eigen::Matrix3d by_rate = 0.5 * dt * middle * skew(force);
  B.block<3, 3>(ImuMotionIndex::kRotation, 0) = -dt * right_jacobian;
  B.block<3, 3>(ImuMotionIndex::kVelocity, 0) = dt * by_rate;
  B.block<3, 3>(ImuMotionIndex::kPosition, 0) = 0.5 * dt * dt * by_rate;
  B.block<3, 3>(ImuMotionIndex::kVelocity, 3) = -dt * middle;
  B.block<3, 3>(ImuMotionIndex::kPosition, 3) = -0.5 * dt * dt * middle;

  // white noise over the step; in a gap one unknown constant
  const double rate_variance = sample.is_gap ? kGapRate_rad_s * kGapRate_rad_s * dt * dt
                                             : noise_.gyro_density * noise_.gyro_density * dt;
  const double force_variance = sample.is_gap ? kGapForce_m_s2 * kGapForce_m_s2 * dt * dt
                                              : noise_.accel_density * noise_.accel_density * dt;
  Matrix9d noise = Matrix9d::Zero();
  noise.diagonal().segment<3>(ImuMotionIndex::kRotation).setConstant(rate_variance);
  noise.diagonal().segment<3>(ImuMotionIndex::kVelocity).setConstant(force_variance);
  noise.diagonal().segment<3>(ImuMotionIndex::kPosition).setConstant(force_variance * dt * dt / 3);
  for (int i = 0; i < 3; ++i) {
    noise(ImuMotionIndex::kVelocity + i, ImuMotionIndex::kPosition + i) = noise(
        ImuMotionIndex::kPosition + i, ImuMotionIndex::kVelocity + i) = force_variance * dt / 2;
  }
  covariance_ = A * covariance_ * A.transpose() + noise;
  bias_jacobian_ = A * bias_jacobian_ + B;

  motion_.position += dt * motion_.velocity + 0.5 * dt * dt * middle * force;
  motion_.velocity += dt * middle * force;
  motion_.rotation = (motion_.rotation * so3_exp(step_rad)).normalized();
  duration_s_ += dt;
}

ImuPreintegration::Motion ImuPreintegration::motion(const Eigen::Vector3d& gyro_bias_rad_s,
                                                    const Eigen::Vector3d& accel_bias_m_s2) const {
  Eigen::Matrix<double, 6, 1> bias;
  bias << gyro_bias_rad_s - gyro_bias_rad_s_, accel_bias_m_s2 - accel_bias_m_s2_;
  const Eigen::Matrix<double, 9, 1> change = bias_jacobian_ * bias;
  return {(motion_.rotation * so3_exp(change.segment<3>(ImuMotionIndex::kRotation))).normalized(),
          motion_.velocity + change.segment<3>(ImuMotionIndex::kVelocity),
          motion_.position + change.segment<3>(ImuMotionIndex::kPosition)};
}

InertialState ImuPreintegration::predict(const InertialState& start) const {
  const Motion change = motion(start.gyro_bias_rad_s, start.accel_bias_m_s2);
  const Eigen::Vector3d g = gravity_in_world();
  const Eigen::Quaterniond& rotation = start.world_from_imu.rotation;
  InertialState end = start;
  end.world_from_imu.rotation = (rotation * change.rotation).normalized();
  end.world_from_imu.translation += duration_s_ * start.velocity_in_world_m_s +
                                    0.5 * duration_s_ * duration_s_ * g +
                                    rotation * change.position;
  end.velocity_in_world_m_s += duration_s_ * g + rotation * change.velocity;
  return end;
}

Eigen::Vector3d gravity_in_world() {
  return {0, 0, -kGravity_m_s2};
}

}  // namespace stillkite
