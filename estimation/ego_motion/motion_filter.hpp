#pragma once

#include <Eigen/Core>

#include "estimation/twist.hpp"
#include "geometry/fields.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

struct MotionFilterConfig {
  double acceleration_density = 0.2;
  double angular_acceleration_density = 0.3;

  static void fields(auto& self, auto&& field) {
    field("acceleration_density", self.acceleration_density, Range{1e-9, 1e9},
          "white acceleration of the drone, m/s^2/sqrt(Hz)");
    field("angular_acceleration_density", self.angular_acceleration_density, Range{1e-9, 1e9},
          "white angular acceleration of the drone, rad/s^2/sqrt(Hz)");
  }
};

/// Kalman filter of a camera that moves at nearly constant velocity, fed with poses whose errors
/// are white (an alignment to a keyframe), with their full covariance: speed and angular rate are
/// confused in an image (correlation near -0.98), so their axes cannot be filtered one by one.
/// State: pose, velocity in world, angular rate in camera. Errors in that order, pose errors in
/// world axes; white acceleration drives it (Bar-Shalom et al. 2001, section 6.2).
class MotionFilter {
 public:
  explicit MotionFilter(const MotionFilterConfig& config);

  /// At rest at `pose`, as far as the standard deviations say.
  void start(const RigidTransform& pose, double velocity_sigma_m_s, double rate_sigma_rad_s);

  void predict(double dt_s);
  void update(const RigidTransform& measured_pose, const Matrix6d& covariance);
  /// A pose that was measured for an assumed twist and would have been another one for another:
  /// `pose_by_twist` is its derivative by the twist in the camera.
  void update(const RigidTransform& measured_pose, const Matrix6d& covariance,
              const Twist& assumed_twist, const Matrix6d& pose_by_twist);

  /// By a gyro in the camera's axes.
  void update_rate(const Eigen::Vector3d& measured_rate_rad_s, const Eigen::Matrix3d& covariance);

  /// Poses are told relative to this one from now on: it has no error.
  void take_as_origin();

  /// The camera may be elsewhere by so much.
  void doubt_place(double sigma_m) { P_.diagonal().head<3>().array() += sigma_m * sigma_m; }

  /// At rest, as far as the standard deviations say; where, is as uncertain as before.
  void forget_speed(double velocity_sigma_m_s, double rate_sigma_rad_s);

  /// The world was turned and shifted: new = change * old.
  void transform_world(const RigidTransform& change);

  /// Lengths in the world were wrong: positions, from its origin, and velocities grow by `factor`.
  void stretch_world(double factor);

  [[nodiscard]] const RigidTransform& pose() const { return pose_; }
  /// Twist at the last frame, or as predicted.
  [[nodiscard]] Twist twist_in_camera() const;
  /// Covariance of (velocity, rate) in the camera at the last frame.
  [[nodiscard]] Matrix6d twist_covariance() const;
  /// Mean twist over the last interval, in the camera half way: the way between its two poses, the
  /// first one smoothed by the last frame. Where there is no interval, the last frame's twist.
  [[nodiscard]] Twist mean_twist_in_camera() const;
  [[nodiscard]] Matrix6d mean_twist_covariance() const;
  [[nodiscard]] Matrix6d pose_covariance() const { return P_.topLeftCorner<6, 6>(); }

 private:
  using Matrix12d = Eigen::Matrix<double, 12, 12>;
  using Vector12d = Eigen::Matrix<double, 12, 1>;
  using PoseWithState = Eigen::Matrix<double, 6, 12>;

  // Kalman update by an innovation of H times the error.
  template <int kRows>
  void correct(const Eigen::Matrix<double, kRows, 12>& H,
               const Eigen::Matrix<double, kRows, 1>& innovation,
               const Eigen::Matrix<double, kRows, kRows>& covariance);
  void transform_errors(const Matrix12d& by);
  // of the way from the frame before to the last one, (translation, rotation vector) in world
  [[nodiscard]] Matrix6d way_covariance() const;

  MotionFilterConfig config_;
  RigidTransform pose_;
  Eigen::Vector3d velocity_in_world_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d rate_in_camera_ = Eigen::Vector3d::Zero();
  Matrix12d P_ = Matrix12d::Zero();

  // the pose of the frame before, smoothed by the last one
  RigidTransform previous_pose_;
  Matrix6d previous_covariance_ = Matrix6d::Zero();
  PoseWithState previous_with_state_ = PoseWithState::Zero();  // its cross covariance
  double interval_s_ = 0;                                      // 0: no frame before
};

}  // namespace stillkite
