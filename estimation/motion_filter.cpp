#include "estimation/motion_filter.hpp"

#include <Eigen/Cholesky>

namespace stillkite {

MotionFilter::MotionFilter(const MotionFilterConfig& config) : config_(config) {}

void MotionFilter::start(const RigidTransform& pose, double velocity_sigma_m_s,
                         double rate_sigma_rad_s) {
  pose_ = pose;
  P_.setZero();
  forget_speed(velocity_sigma_m_s, rate_sigma_rad_s);
}

void MotionFilter::take_as_origin() {
  P_.topRows<6>().setZero();
  P_.leftCols<6>().setZero();
}

void MotionFilter::forget_speed(double velocity_sigma_m_s, double rate_sigma_rad_s) {
  velocity_in_world_.setZero();
  rate_in_camera_.setZero();
  previous_velocity_in_world_.setZero();
  previous_rate_in_camera_.setZero();
  previous_with_predicted_.setZero();
  P_.bottomRows<6>().setZero();
  P_.rightCols<6>().setZero();
  P_.diagonal().segment<3>(6).setConstant(velocity_sigma_m_s * velocity_sigma_m_s);
  P_.diagonal().segment<3>(9).setConstant(rate_sigma_rad_s * rate_sigma_rad_s);
}

RigidTransform MotionFilter::predicted_pose(double dt_s) const {
  return {(pose_.rotation * so3_exp(rate_in_camera_ * dt_s)).normalized(),
          pose_.translation + velocity_in_world_ * dt_s};
}

void MotionFilter::predict(double dt_s) {
  const Eigen::Matrix3d R = pose_.rotation.toRotationMatrix();
  pose_ = predicted_pose(dt_s);
  interval_s_ = dt_s;
  Matrix12d F = Matrix12d::Identity();
  F.block<3, 3>(0, 6).diagonal().setConstant(dt_s);
  F.block<3, 3>(3, 9) = R * dt_s;

  // white acceleration over dt: [dt^3/3, dt^2/2; dt^2/2, dt] q^2
  Matrix12d Q = Matrix12d::Zero();
  const double dt2 = dt_s * dt_s / 2;
  const double dt3 = dt_s * dt_s * dt_s / 3;
  const double qv = config_.acceleration_density * config_.acceleration_density;
  const double qw = config_.angular_acceleration_density * config_.angular_acceleration_density;
  Q.block<3, 3>(0, 0).diagonal().setConstant(qv * dt3);
  Q.block<3, 3>(0, 6).diagonal().setConstant(qv * dt2);
  Q.block<3, 3>(6, 0).diagonal().setConstant(qv * dt2);
  Q.block<3, 3>(6, 6).diagonal().setConstant(qv * dt_s);
  Q.block<3, 3>(3, 3).diagonal().setConstant(qw * dt3);
  Q.block<3, 3>(3, 9) = R * (qw * dt2);
  Q.block<3, 3>(9, 3) = R.transpose() * (qw * dt2);
  Q.block<3, 3>(9, 9).diagonal().setConstant(qw * dt_s);

  previous_with_predicted_ = P_ * F.transpose();
  P_ = F * previous_with_predicted_ + Q;
  previous_velocity_in_world_ = velocity_in_world_;
  previous_rate_in_camera_ = rate_in_camera_;
}

template <int kRows>
void MotionFilter::correct(int first, const Eigen::Matrix<double, kRows, 1>& innovation,
                           const Eigen::Matrix<double, kRows, kRows>& covariance) {
  using Gain = Eigen::Matrix<double, 12, kRows>;
  const Eigen::Matrix<double, kRows, kRows> S = P_.block<kRows, kRows>(first, first) + covariance;
  const Eigen::LDLT<Eigen::Matrix<double, kRows, kRows>> ldlt(S);
  const Gain PHt = P_.middleCols<kRows>(first);
  const Gain K = ldlt.solve(PHt.transpose()).transpose();
  const Vector12d correction = K * innovation;
  // the smoother's gain on the same innovation: cov(x_{j-1}, z) S^-1
  const Vector12d back = previous_with_predicted_.middleCols<kRows>(first) * ldlt.solve(innovation);

  pose_.translation += correction.head<3>();
  pose_.rotation = (so3_exp(correction.segment<3>(3)) * pose_.rotation).normalized();
  velocity_in_world_ += correction.segment<3>(6);
  rate_in_camera_ += correction.tail<3>();
  previous_velocity_in_world_ += back.segment<3>(6);
  previous_rate_in_camera_ += back.tail<3>();

  // Joseph form keeps P symmetric and positive
  Matrix12d I_KH = Matrix12d::Identity();
  I_KH.middleCols<kRows>(first) -= K;
  const Matrix12d P = I_KH * P_ * I_KH.transpose() + K * covariance * K.transpose();
  P_ = 0.5 * (P + P.transpose());
  previous_with_predicted_ = previous_with_predicted_ * I_KH.transpose();
}

void MotionFilter::update(const RigidTransform& measured_pose, const Matrix6d& covariance) {
  Vector6d innovation;
  innovation << measured_pose.translation - pose_.translation,
      so3_log(measured_pose.rotation * pose_.rotation.conjugate());
  correct<6>(0, innovation, covariance);
}

void MotionFilter::update_rate(const Eigen::Vector3d& measured_rate_rad_s,
                               const Eigen::Matrix3d& covariance) {
  correct<3>(9, measured_rate_rad_s - rate_in_camera_, covariance);
}

void MotionFilter::transform_world(const RigidTransform& change) {
  pose_ = change * pose_;
  velocity_in_world_ = change.rotation * velocity_in_world_;
  previous_velocity_in_world_ = change.rotation * previous_velocity_in_world_;
  const Eigen::Matrix3d R = change.rotation.toRotationMatrix();
  Matrix12d J = Matrix12d::Identity();
  for (const int at : {0, 3, 6}) J.block<3, 3>(at, at) = R;
  P_ = J * P_ * J.transpose();
}

void MotionFilter::stretch_world(double factor) {
  pose_.translation *= factor;
  velocity_in_world_ *= factor;
  previous_velocity_in_world_ *= factor;
  for (const int at : {0, 6}) {
    P_.middleRows<3>(at) *= factor;
    P_.middleCols<3>(at) *= factor;
  }
}

Twist MotionFilter::twist_in_camera() const {
  return {pose_.rotation.conjugate() * velocity_in_world_, rate_in_camera_};
}

Twist MotionFilter::mean_twist_in_camera() const {
  const Eigen::Vector3d velocity = 0.5 * (velocity_in_world_ + previous_velocity_in_world_);
  const Eigen::Vector3d rate = 0.5 * (rate_in_camera_ + previous_rate_in_camera_);
  const Eigen::Quaterniond half_way = pose_.rotation * so3_exp(rate * (-0.5 * interval_s_));
  return {half_way.conjugate() * velocity, rate};
}

Matrix6d MotionFilter::twist_covariance() const {
  Matrix6d J = Matrix6d::Identity();
  J.topLeftCorner<3, 3>() = pose_.rotation.conjugate().toRotationMatrix();
  return J * P_.bottomRightCorner<6, 6>() * J.transpose();
}

}  // namespace stillkite
