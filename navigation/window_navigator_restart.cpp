// Restarts of WindowNavigator, and its return to the reference keyframe from before.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/chi_square.hpp"
#include "navigation/window_navigator.hpp"

namespace stillkite {

void WindowNavigator::lose_reference() {
  const Window& window = window_.window();
  if (lost_reference_ || !window_.is_initialized()) return;
  KeyframeMap map = keyframe_map(window, window.reference_id);
  if (map.points.empty()) return;
  lost_reference_ = LostReference{std::move(map), origin_covariance_ + mount_covariance()};
  features_.lose_reference();
}

// Of the body's pose relative to the camera's, (translation, rotation) in the world.
Matrix6d WindowNavigator::mount_covariance() const {
  const Eigen::Matrix3d R = window_.state().world_from_imu.rotation.toRotationMatrix();
  Matrix6d J = Matrix6d::Zero();
  J.block<3, 3>(0, ExtrinsicsIndex::kLeverArm) = R;
  J.block<3, 3>(3, ExtrinsicsIndex::kRotation) =
      R * window_.extrinsics().imu_from_camera.rotation.toRotationMatrix();
  return J * window_.mount_covariance() * J.transpose();
}

void WindowNavigator::forget_lost_reference() {
  lost_reference_.reset();
  features_.forget_lost();
}

// Position and yaw by the reference keyframe before a restart, if it is in view.
bool WindowNavigator::relocalize(const Frame& frame) {
  constexpr double kMaxSigmas = 5;
  if (!lost_reference_ || !window_.is_initialized()) return false;
  const RigidTransform& imu_from_camera = window_.extrinsics().imu_from_camera;
  const RigidTransform world_from_camera = window_.world_from_imu() * imu_from_camera;
  const KeyframeMap& map = lost_reference_->map;
  const auto located = locate_camera(map, features_.search_lost(frame),
                                     map.world_from_camera.inverse() * world_from_camera);
  if (!located) return false;
  const RigidTransform measured = map.world_from_camera * located->keyframe_from_camera;
  // (translation, rotation) in the world
  Matrix6d J = Matrix6d::Zero();
  J.topRightCorner<3, 3>() = map.world_from_camera.rotation.toRotationMatrix();
  J.bottomLeftCorner<3, 3>() = measured.rotation.toRotationMatrix();
  const Matrix6d covariance =
      lost_reference_->covariance + mount_covariance() + J * located->covariance * J.transpose();
  const Eigen::Quaterniond turn = measured.rotation * world_from_camera.rotation.conjugate();
  Vector6d difference;
  difference << measured.translation - world_from_camera.translation, so3_log(turn);
  const Matrix6d expected = covariance + pose_covariance(frame.stamp);
  const double squared = difference.dot(expected.ldlt().solve(difference));
  if (!(squared < chi_square_at_sigmas(kMaxSigmas, 6))) return false;
  const Eigen::Quaterniond yaw = so3_exp({0, 0, 2 * std::atan2(turn.z(), turn.w())});
  const Eigen::Vector3d before = window_.world_from_imu().translation;
  const RigidTransform world_from_imu = measured * imu_from_camera.inverse();
  window_.move(yaw, before, world_from_imu.translation);
  initial_position_m_ = world_from_imu.translation + yaw * (initial_position_m_ - before);
  origin_covariance_ = covariance;
  forget_lost_reference();
  return true;
}

// A bias or a camera rotation that its prior excludes is none, but axes, scale or units.
void WindowNavigator::restart_if_contradictory(Timestamp stamp) {
  const std::optional<InertialFinding> contradiction = prior_contradiction(window_);
  if (!contradiction) return;
  contradiction_ = contradiction;
  const double moved_m2 =
      (window_.state().world_from_imu.translation - initial_position_m_).squaredNorm();
  restart(stamp);
  // its scale is unknown
  origin_covariance_.diagonal().head<3>().array() += moved_m2;
  forget_lost_reference();
}

void WindowNavigator::restart_if_lost(Timestamp stamp) {
  // without any feature there is nothing to initialize from
  if (window_.is_restarted() && window_.window().tracks.empty()) window_.restart();
  if (!window_.is_initialized()) return;
  if (seconds_between(last_measured_, stamp) > max_unmeasured_s_) restart(stamp);
}

void WindowNavigator::restart(Timestamp stamp) {
  lose_reference();
  origin_covariance_ = pose_covariance(stamp);
  const double speed_variance =
      window_.covariance().block<3, 3>(InertialIndex::kVelocity, InertialIndex::kVelocity).trace();
  unmeasured_speed_m_s_ =
      std::sqrt(window_.state().velocity_in_world_m_s.squaredNorm() + speed_variance);
  last_measured_ = stamp;
  window_.restart();
}

// Covariances of (translation, rotation vector) in the world.
Matrix6d WindowNavigator::unmeasured_covariance(Timestamp stamp) const {
  Matrix6d out = origin_covariance_;
  const double unmeasured_s = std::max(0.0, seconds_between(last_measured_, stamp));
  const double displacement_m = unmeasured_speed_m_s_ * unmeasured_s;
  const double rotation_rad = rate_sigma_rad_s_ * unmeasured_s;
  out.diagonal().head<3>().array() += displacement_m * displacement_m;
  out.diagonal().tail<3>().array() += rotation_rad * rotation_rad;
  return out;
}

Matrix6d WindowNavigator::pose_covariance(Timestamp stamp) const {
  if (!window_.is_initialized()) return unmeasured_covariance(stamp);
  Matrix6d out = origin_covariance_;
  Matrix6d J = Matrix6d::Zero();
  J.topRightCorner<3, 3>().setIdentity();
  J.bottomLeftCorner<3, 3>() = window_.state().world_from_imu.rotation.toRotationMatrix();
  // roll and pitch are the window's own, yaw and position are relative to its first frame
  out.block<5, 5>(0, 0).bottomRightCorner<2, 2>().setZero();
  out.block<2, 6>(3, 0).setZero();
  out.block<6, 2>(0, 3).setZero();
  return out + J * window_.covariance().topLeftCorner<6, 6>() * J.transpose();
}

}  // namespace stillkite
