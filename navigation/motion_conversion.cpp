#include "navigation/motion_conversion.hpp"

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

EstimateStatus status_of(const NavigationEstimate& estimate) {
  if (is_measured(estimate.verdict)) return EstimateStatus::ok;
  const bool is_predicted =
      estimate.source == EstimateSource::fused && estimate.scale != ScaleSource::none;
  return is_predicted ? EstimateStatus::predicted : EstimateStatus::lost;
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

MotionEstimate motion_from_initial(const NavigationEstimate& estimate,
                                   const RigidTransform& world_from_initial,
                                   const RigidTransform& body_from_camera) {
  const RigidTransform initial_from_camera =
      world_from_initial.inverse() * (estimate.world_from_body * body_from_camera);
  const Eigen::Matrix3d R = world_from_initial.rotation.conjugate().toRotationMatrix();
  const bool is_metric = estimate.scale != ScaleSource::none;
  MotionEstimate motion;
  motion.stamp = estimate.stamp;
  motion.source = estimate.source;
  motion.status = status_of(estimate);
  motion.reference_from_camera = initial_from_camera.rotation;
  motion.rotation_covariance =
      R * estimate.pose_covariance.bottomRightCorner<3, 3>() * R.transpose();
  motion.displacement_kind = is_metric ? DisplacementKind::metric : DisplacementKind::unknown;
  motion.displacement_in_reference = initial_from_camera.translation;
  motion.displacement_covariance =
      R * estimate.pose_covariance.topLeftCorner<3, 3>() * R.transpose();
  motion.twist_in_camera = estimate.twist_in_camera;
  motion.scale = estimate.scale;
  motion.scale_age_s = estimate.scale_age_s;
  return motion;
}

}  // namespace stillkite
