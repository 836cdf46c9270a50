#include "estimation/ego_motion/motion_filter.hpp"

#include <Eigen/Cholesky>
#include <limits>

namespace stillkite {
namespace {

// Rounding dominates the displacement of shorter intervals.
constexpr double kMinInterval_s = 1e-6;

// Of the position innovation given the rotation innovation, without its constant. NaN: unknown.
double position_log_likelihood(const Vector6d& innovation, const Matrix6d& S) {
  const Eigen::Matrix3d gain = S.topRightCorner<3, 3>() * S.bottomRightCorner<3, 3>().inverse();
  const Eigen::LDLT<Eigen::Matrix3d> ldlt(S.topLeftCorner<3, 3>() -
                                          gain * S.bottomLeftCorner<3, 3>());
  // the stamp's error can make position and rotation fully correlated
  if (!(ldlt.vectorD().minCoeff() > 0)) return std::numeric_limits<double>::quiet_NaN();
  const Eigen::Vector3d residual = innovation.head<3>() - gain * innovation.tail<3>();
  return -0.5 * (residual.dot(ldlt.solve(residual)) + ldlt.vectorD().array().log().sum());
}

}  // namespace

MotionFilter::MotionFilter(const MotionFilterConfig& config) : config_(config) {}

void MotionFilter::initialize(const RigidTransform& pose, double velocity_sigma_m_s,
                              double rate_sigma_rad_s) {
  state_.pose = pose;
  state_.covariance.setZero();
  reset_twist(velocity_sigma_m_s, rate_sigma_rad_s);
}

void MotionFilter::set_pose_as_origin() {
  previous_covariance_ = relative_pose_covariance();
  previous_cross_covariance_.setZero();
  state_.covariance.topRows<6>().setZero();
  state_.covariance.leftCols<6>().setZero();
}

void MotionFilter::reset_twist(double velocity_sigma_m_s, double rate_sigma_rad_s) {
  state_.velocity_in_world.setZero();
  state_.rate_in_camera.setZero();
  interval_s_ = 0;
  state_.covariance.bottomRows<6>().setZero();
  state_.covariance.rightCols<6>().setZero();
  state_.covariance.diagonal().segment<3>(6).setConstant(velocity_sigma_m_s * velocity_sigma_m_s);
  state_.covariance.diagonal().segment<3>(9).setConstant(rate_sigma_rad_s * rate_sigma_rad_s);
}

void MotionFilter::predict(double dt_s) {
  const Eigen::Matrix3d R = state_.pose.rotation.toRotationMatrix();
  previous_pose_ = state_.pose;
  previous_covariance_ = pose_covariance();
  state_.pose = {(state_.pose.rotation * so3_exp(state_.rate_in_camera * dt_s)).normalized(),
                 state_.pose.translation + state_.velocity_in_world * dt_s};
  interval_s_ = dt_s;
  Matrix12d F = Matrix12d::Identity();
  F.block<3, 3>(0, 6).diagonal().setConstant(dt_s);
  F.block<3, 3>(3, 9) = R * dt_s;

  // process noise of white acceleration over dt: [dt^3/3, dt^2/2; dt^2/2, dt] q^2
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

  const Matrix12d PFt = state_.covariance * F.transpose();
  previous_cross_covariance_ = PFt.topRows<6>();
  state_.covariance = F * PFt + Q;
}

template <int kRows>
Eigen::Matrix<double, kRows, kRows> MotionFilter::correct(
    const Eigen::Matrix<double, kRows, 12>& H, const Eigen::Matrix<double, kRows, 1>& innovation,
    const Eigen::Matrix<double, kRows, kRows>& covariance) {
  using Gain = Eigen::Matrix<double, 12, kRows>;
  const Gain PHt = state_.covariance * H.transpose();
  const Eigen::Matrix<double, kRows, kRows> S = H * PHt + covariance;
  const Eigen::LDLT<Eigen::Matrix<double, kRows, kRows>> ldlt(S);
  const Gain K = ldlt.solve(PHt.transpose()).transpose();
  const Vector12d correction = K * innovation;
  // smoother gain: cov(pose_{j-1}, z) S^-1
  const Eigen::Matrix<double, 6, kRows> cross_PHt = previous_cross_covariance_ * H.transpose();
  const Vector6d smoothing = cross_PHt * ldlt.solve(innovation);

  state_.pose.translation += correction.head<3>();
  state_.pose.rotation = (so3_exp(correction.segment<3>(3)) * state_.pose.rotation).normalized();
  state_.velocity_in_world += correction.segment<3>(6);
  state_.rate_in_camera += correction.tail<3>();
  previous_pose_.translation += smoothing.head<3>();
  previous_pose_.rotation = (so3_exp(smoothing.tail<3>()) * previous_pose_.rotation).normalized();

  // Joseph form keeps P symmetric and positive definite
  const Matrix12d I_KH = Matrix12d::Identity() - K * H;
  const Matrix12d P = I_KH * state_.covariance * I_KH.transpose() + K * covariance * K.transpose();
  state_.covariance = 0.5 * (P + P.transpose());
  previous_covariance_ -= cross_PHt * ldlt.solve(cross_PHt.transpose());
  previous_cross_covariance_ = previous_cross_covariance_ * I_KH.transpose();
  return S;
}

void MotionFilter::update(const RigidTransform& measured_pose, const Matrix6d& covariance) {
  update(measured_pose, covariance, twist_in_camera(), Matrix6d::Zero());
}

double MotionFilter::update(const RigidTransform& measured_pose, const Matrix6d& covariance,
                            const Twist& assumed_twist, const Matrix6d& pose_by_twist) {
  Vector6d innovation;
  innovation << measured_pose.translation - state_.pose.translation,
      so3_log(measured_pose.rotation * state_.pose.rotation.conjugate());
  innovation -= pose_by_twist * (assumed_twist.vector() - twist_in_camera().vector());
  PoseWithState H;
  H << Matrix6d::Identity(),
      -pose_by_twist.leftCols<3>() * state_.pose.rotation.conjugate().toRotationMatrix(),
      -pose_by_twist.rightCols<3>();
  return position_log_likelihood(innovation, correct<6>(H, innovation, covariance));
}

void MotionFilter::update_rate(const Eigen::Vector3d& measured_rate_rad_s,
                               const Eigen::Matrix3d& covariance) {
  Eigen::Matrix<double, 3, 12> H = Eigen::Matrix<double, 3, 12>::Zero();
  H.rightCols<3>().setIdentity();
  correct<3>(H, measured_rate_rad_s - state_.rate_in_camera, covariance);
}

void MotionFilter::transform_world(const RigidTransform& change) {
  state_.pose = change * state_.pose;
  previous_pose_ = change * previous_pose_;
  state_.velocity_in_world = change.rotation * state_.velocity_in_world;
  const Eigen::Matrix3d R = change.rotation.toRotationMatrix();
  Matrix12d J = Matrix12d::Identity();
  for (const int at : {0, 3, 6}) J.block<3, 3>(at, at) = R;
  transform_errors(J);
}

void MotionFilter::rescale_world(double factor) {
  state_.pose.translation *= factor;
  previous_pose_.translation *= factor;
  state_.velocity_in_world *= factor;
  Matrix12d J = Matrix12d::Identity();
  for (const int at : {0, 6}) J.block<3, 3>(at, at) *= factor;
  transform_errors(J);
}

void MotionFilter::transform_errors(const Matrix12d& J) {
  const Matrix6d J_pose = J.topLeftCorner<6, 6>();
  state_.covariance = J * state_.covariance * J.transpose();
  previous_covariance_ = J_pose * previous_covariance_ * J_pose.transpose();
  previous_cross_covariance_ = J_pose * previous_cross_covariance_ * J.transpose();
}

Twist MotionFilter::twist_in_camera() const {
  return {state_.pose.rotation.conjugate() * state_.velocity_in_world, state_.rate_in_camera};
}

Matrix6d MotionFilter::twist_covariance() const {
  Matrix6d J = Matrix6d::Identity();
  J.topLeftCorner<3, 3>() = state_.pose.rotation.conjugate().toRotationMatrix();
  return J * state_.covariance.bottomRightCorner<6, 6>() * J.transpose();
}

Twist MotionFilter::mean_twist_in_camera() const {
  if (interval_s_ < kMinInterval_s) return twist_in_camera();
  const Eigen::Vector3d rotation_vector =
      so3_log(previous_pose_.rotation.conjugate() * state_.pose.rotation);
  const Eigen::Quaterniond world_from_middle =
      previous_pose_.rotation * so3_exp(0.5 * rotation_vector);
  const Eigen::Vector3d displacement = state_.pose.translation - previous_pose_.translation;
  return {world_from_middle.conjugate() * displacement / interval_s_,
          rotation_vector / interval_s_};
}

Matrix6d MotionFilter::relative_pose_covariance() const {
  const Matrix6d cross = previous_cross_covariance_.leftCols<6>();
  return pose_covariance() + previous_covariance_ - cross - cross.transpose();
}

Matrix6d MotionFilter::mean_twist_covariance() const {
  if (interval_s_ < kMinInterval_s) return twist_covariance();
  Matrix6d J = Matrix6d::Zero();
  J.topLeftCorner<3, 3>() = state_.pose.rotation.conjugate().toRotationMatrix() / interval_s_;
  J.bottomRightCorner<3, 3>() = J.topLeftCorner<3, 3>();
  return J * relative_pose_covariance() * J.transpose();
}

}  // namespace stillkite
