#pragma once

#include <Eigen/Core>

#include "estimation/ego_motion/motion_filter_config.hpp"
#include "estimation/twist.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// Constant-velocity Kalman filter of a camera, driven by white acceleration (Bar-Shalom et al.
/// 2001, section 6.2). Measurements: poses with white errors and full covariance (keyframe
/// alignment).
///
/// The full covariance is needed: image errors of velocity and angular rate are correlated at about
/// -0.98.
class MotionFilter {
 public:
  /// Covariance order: pose (translation, rotation vector in world), velocity in world, angular
  /// rate in camera.
  struct State {
    RigidTransform pose;
    Eigen::Vector3d velocity_in_world = Eigen::Vector3d::Zero();
    Eigen::Vector3d rate_in_camera = Eigen::Vector3d::Zero();
    Eigen::Matrix<double, 12, 12> covariance = Eigen::Matrix<double, 12, 12>::Zero();
  };

  explicit MotionFilter(const MotionFilterConfig& config);

  [[nodiscard]] const State& state() const { return state_; }
  /// Replaces the state before a prediction (interacting models).
  void set_state(const State& state) { state_ = state; }

  /// Initial state: `pose` without error, zero twist with the given standard deviations.
  void initialize(const RigidTransform& pose, double velocity_sigma_m_s, double rate_sigma_rad_s);

  void predict(double dt_s);
  void update(const RigidTransform& measured_pose, const Matrix6d& covariance);
  /// Update by a pose measured under an assumed twist (rolling shutter). `pose_by_twist`:
  /// derivative of the measured pose with respect to the twist in camera. Returns the
  /// log-likelihood of the measured position given the measured rotation, without its constant.
  double update(const RigidTransform& measured_pose, const Matrix6d& covariance,
                const Twist& assumed_twist, const Matrix6d& pose_by_twist);

  /// Update by a gyro measurement in camera axes.
  void update_rate(const Eigen::Vector3d& measured_rate_rad_s, const Eigen::Matrix3d& covariance);

  /// Makes the current pose the origin: its error becomes zero by definition.
  void set_pose_as_origin();

  /// Adds `sigma_m`^2 to the position variance of each axis.
  void inflate_position_covariance(double sigma_m) {
    state_.covariance.diagonal().head<3>().array() += sigma_m * sigma_m;
  }

  /// Resets the twist to zero with the given standard deviations; keeps the pose covariance.
  void reset_twist(double velocity_sigma_m_s, double rate_sigma_rad_s);

  /// Transforms the world frame: new = change * old.
  void transform_world(const RigidTransform& change);

  /// Scales positions, about the world origin, and velocities by `factor`.
  void rescale_world(double factor);

  [[nodiscard]] const RigidTransform& pose() const { return state_.pose; }
  /// Twist at the current time (updated or predicted).
  [[nodiscard]] Twist twist_in_camera() const;
  /// Covariance of (velocity, angular rate), both in camera.
  [[nodiscard]] Matrix6d twist_covariance() const;
  /// Mean twist over the last interval, in camera at its middle: displacement between its two
  /// poses, the first one smoothed by the last measurement. Without an interval:
  /// `twist_in_camera()`.
  [[nodiscard]] Twist mean_twist_in_camera() const;
  [[nodiscard]] Matrix6d mean_twist_covariance() const;
  [[nodiscard]] Matrix6d pose_covariance() const { return state_.covariance.topLeftCorner<6, 6>(); }

 private:
  using Matrix12d = Eigen::Matrix<double, 12, 12>;
  using Vector12d = Eigen::Matrix<double, 12, 1>;
  using PoseWithState = Eigen::Matrix<double, 6, 12>;

  // Kalman update: innovation = H error + noise. Returns the innovation covariance.
  template <int kRows>
  Eigen::Matrix<double, kRows, kRows> correct(
      const Eigen::Matrix<double, kRows, 12>& H, const Eigen::Matrix<double, kRows, 1>& innovation,
      const Eigen::Matrix<double, kRows, kRows>& covariance);
  // P <- J P J^T.
  void transform_errors(const Matrix12d& J);
  // Covariance of the motion over the last interval, (translation, rotation vector) in world.
  [[nodiscard]] Matrix6d relative_pose_covariance() const;

  MotionFilterConfig config_;
  State state_;

  // pose of the previous frame, fixed-lag smoothed by the last measurement
  RigidTransform previous_pose_;
  Matrix6d previous_covariance_ = Matrix6d::Zero();
  PoseWithState previous_cross_covariance_ = PoseWithState::Zero();  // with the state
  double interval_s_ = 0;                                            // 0: no previous frame
};

}  // namespace stillkite
