#include "navigation/motion_from_pose.hpp"

namespace stillkite {
namespace {

// Camera origin in the reference frame, -R^T t. Errors e of the rotation (R = exp(e) R_true) and
// e_t of t change it by -R^T (e_t + [t]x e).
void set_displacement(const RelativePoseEstimate& pose, MotionEstimate& motion) {
  const Eigen::Matrix3d R = pose.pose.current_from_reference.toRotationMatrix();
  Eigen::Matrix<double, 3, 6> J;
  J << -R.transpose() * skew(pose.pose.direction), -R.transpose();
  motion.displacement_in_reference = -(R.transpose() * pose.pose.direction);
  motion.displacement_covariance = J * pose.covariance * J.transpose();
}

}  // namespace

MotionEstimate motion_from_pose(const RelativePoseEstimate& pose) {
  MotionEstimate motion;
  const Eigen::Quaterniond reference_from_camera = pose.pose.current_from_reference.conjugate();
  const Eigen::Matrix3d R = reference_from_camera.toRotationMatrix();
  motion.source = EstimateSource::reference;
  motion.status = EstimateStatus::ok;
  motion.reference_from_camera = reference_from_camera;
  motion.rotation_covariance = R * pose.covariance.topLeftCorner<3, 3>() * R.transpose();
  const bool has_direction = !pose.pose.direction.isZero();
  motion.displacement_kind = has_direction ? DisplacementKind::direction : DisplacementKind::zero;
  if (has_direction) set_displacement(pose, motion);
  return motion;
}

RelativePose pose_from_motion(const MotionEstimate& motion) {
  const Eigen::Quaterniond current_from_reference = motion.reference_from_camera.conjugate();
  return {current_from_reference, -(current_from_reference * motion.displacement_in_reference)};
}

}  // namespace stillkite
