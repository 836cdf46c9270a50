#include <algorithm>
#include <cmath>

#include "estimation/fusion/fusion_filter.hpp"
#include "geometry/gravity.hpp"

namespace stillkite {
namespace {

using Index = FusionIndex;
constexpr double kAnyRateDensity = 0.5;  // rad/s/sqrt(Hz)

// Accelerometers feel its opposite. The world's vertical is off by the tilt: exp(tilt) z.
Eigen::Vector3d gravity_m_s2(const Eigen::Vector2d& tilt_rad) {
  return -kGravity_m_s2 * Eigen::Vector3d(tilt_rad.y(), -tilt_rad.x(), 1);
}

Eigen::Matrix<double, 3, 2> gravity_by_tilt() {
  Eigen::Matrix<double, 3, 2> J;
  J << 0, -kGravity_m_s2, kGravity_m_s2, 0, 0, 0;
  return J;
}

// Of position and velocity (Bar-Shalom et al. 2001, eq. 6.2.2-12), the density squared.
Eigen::Matrix<double, 9, 9> white_acceleration(double squared_density, double dt_s) {
  Eigen::Matrix<double, 9, 9> Q = Eigen::Matrix<double, 9, 9>::Zero();
  for (int i = 0; i < 3; ++i) {
    const int p = Index::kPosition + i;
    const int v = Index::kVelocity + i;
    Q(p, p) = squared_density * dt_s * dt_s * dt_s / 3;
    Q(p, v) = Q(v, p) = squared_density * dt_s * dt_s / 2;
    Q(v, v) = squared_density * dt_s;
  }
  return Q;
}

struct Carried {
  Eigen::Vector3d rate_rad_s;
  Eigen::Vector3d force_in_world_m_s2;  // without gravity
  Eigen::Vector3d acceleration_m_s2;
};

Carried carried(const FusionState& state, const InertialStep& step) {
  Carried out{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  if (step.angular_rate_rad_s) out.rate_rad_s = *step.angular_rate_rad_s;
  if (step.is_gyro && step.angular_rate_rad_s) out.rate_rad_s -= state.gyro_bias_rad_s;
  if (step.specific_force_m_s2) {
    // half way through the step, for what gravity does in a turn
    out.force_in_world_m_s2 = state.world_from_camera.rotation *
                              so3_exp(0.5 * step.dt_s * out.rate_rad_s) *
                              (*step.specific_force_m_s2 - state.accel_bias_m_s2);
    out.acceleration_m_s2 = out.force_in_world_m_s2 + gravity_m_s2(state.gravity_tilt_rad);
  }
  return out;
}

FusionState moved(const FusionState& state, const InertialStep& step) {
  const Carried by = carried(state, step);
  const Eigen::Vector3d acceleration = std::exp(-state.log_scale) * by.acceleration_m_s2;
  FusionState next = state;
  next.world_from_camera.rotation =
      (state.world_from_camera.rotation * so3_exp(by.rate_rad_s * step.dt_s)).normalized();
  next.world_from_camera.translation +=
      state.velocity_in_world * step.dt_s + 0.5 * square(step.dt_s) * acceleration;
  next.velocity_in_world += acceleration * step.dt_s;
  return next;
}

}  // namespace

void FusionFilter::predict(const InertialStep& step) {
  start_.remember([=](FusionFilter& filter) { filter.predict(step); });
  const double dt_s = step.dt_s;
  const bool has_gyro = step.angular_rate_rad_s && step.is_gyro;
  const bool has_accel = step.specific_force_m_s2.has_value();
  const Eigen::Matrix3d R = state_.world_from_camera.rotation.toRotationMatrix();
  const Carried by = carried(state_, step);
  const double shrink = std::exp(-state_.log_scale);

  const double accel_density = has_accel ? config_.accel_density : config_.acceleration_density;
  double squared_density = square(shrink * accel_density);
  Transition F = Transition::Identity();
  F.block<3, 3>(Index::kPosition, Index::kVelocity).diagonal().setConstant(dt_s);
  if (has_gyro) F.block<3, 3>(Index::kRotation, Index::kGyroBias) = -dt_s * R;
  if (has_accel) {
    const double in_map_s = shrink * dt_s;
    Eigen::Matrix<double, 3, Index::kAnchorRotation> by_force;
    by_force.setZero();
    by_force.middleCols<3>(Index::kRotation) = -in_map_s * skew(by.force_in_world_m_s2);
    by_force.middleCols<3>(Index::kAccelBias) = -in_map_s * R;
    by_force.middleCols<2>(Index::kTilt) = in_map_s * gravity_by_tilt();
    by_force.col(Index::kScale) = -shrink * counted_gain(dt_s * by.acceleration_m_s2, dt_s);
    F.middleRows<3>(Index::kVelocity) += by_force;
    F.middleRows<3>(Index::kPosition) += 0.5 * dt_s * by_force;
    // scale and acceleration are multiplied: what neither is known to, no linear step tells
    const Eigen::Matrix3d of_acceleration =
        by_force * P_.topLeftCorner<Index::kAnchorRotation, Index::kAnchorRotation>() *
        by_force.transpose() / square(dt_s);
    squared_density +=
        config_.scale_correlated_s * square(scale_sigma()) * of_acceleration.trace() / 3;
  }
  const double rate_density = has_gyro ? config_.gyro_density : kAnyRateDensity;
  Matrix9d noise = white_acceleration(squared_density, dt_s);
  noise.diagonal().segment<3>(Index::kRotation).setConstant(square(rate_density) * dt_s);
  propagate(F, noise, dt_s);
  if (has_gyro) gyro_s_ += dt_s;
  step_s_ += dt_s;
  has_accel_ |= has_accel;
  state_ = moved(state_, step);
  prediction_.state = state_;
  prediction_.covariance = own_covariance();
}

// What velocity gains is wrong with the scale. A reading's noise is no gain: counted as one, where
// images show that there was none, it tells of longer metres (errors in variables). So what is
// counted is the mean over so long that the noise in it is no more than what a motion of
// kMotion_rad_s changes meanwhile.
Eigen::Vector3d FusionFilter::counted_gain(const Eigen::Vector3d& gain_m_s, double dt_s) {
  constexpr double kMotion_rad_s = 1.5;
  constexpr double kLongest_s = 0.5;
  constexpr double kFrame_s = 0.03;  // in which no image tells
  constexpr double kShortest_s = 1e-3;
  double& mean_square = state_.mean_square_acceleration_m2_s4;
  const double balanced_s =
      std::cbrt(0.5 * square(config_.accel_density / kMotion_rad_s) / mean_square);
  const double averaged_s = std::min(kLongest_s, balanced_s) - kFrame_s;
  const double share = averaged_s > 0 ? -std::expm1(-dt_s / averaged_s) : 1;
  const Eigen::Vector3d counted_m_s = share * (state_.recent_gain_m_s + gain_m_s);
  state_.recent_gain_m_s += gain_m_s - counted_m_s;
  mean_square -=
      std::expm1(-dt_s) * ((counted_m_s / std::max(dt_s, kShortest_s)).squaredNorm() - mean_square);
  return counted_m_s;
}

void FusionFilter::propagate(const Transition& F, const Matrix9d& noise, double dt_s) {
  const int n = size();
  prediction_.transition.topRows<9>() = (F * prediction_.transition).eval();
  const Eigen::MatrixXd rows = F * P_.topLeftCorner(Index::kAnchorRotation, n);
  P_.topLeftCorner(9, n) = rows;
  P_.topLeftCorner(n, 9) = rows.transpose();
  P_.topLeftCorner<9, 9>() = rows.leftCols<Index::kAnchorRotation>() * F.transpose() + noise;
  P_.diagonal().segment<3>(Index::kGyroBias).array() += square(config_.gyro_bias_walk) * dt_s;
  P_.diagonal().segment<3>(Index::kAccelBias).array() += square(config_.accel_bias_walk) * dt_s;
}

}  // namespace stillkite
