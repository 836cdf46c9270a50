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

// Motion since a later reference, in the axes of the first one. Rotation is chained to the first
// reference; the displacement stays relative to the later one, since it has no length.
MotionEstimate relative_to_first_reference(const MotionEstimate& motion,
                                           const Eigen::Quaterniond& initial_from_camera) {
  const Eigen::Quaterniond initial_from_reference =
      initial_from_camera * motion.reference_from_camera.conjugate();
  const Eigen::Matrix3d R = initial_from_reference.toRotationMatrix();
  MotionEstimate out = motion;
  out.reference_from_camera = initial_from_camera;
  out.rotation_covariance = R * motion.rotation_covariance * R.transpose();
  out.displacement_in_reference = R * motion.displacement_in_reference;
  out.displacement_covariance = R * motion.displacement_covariance * R.transpose();
  return out;
}

// The flow levels the current pose, not the initial one (index s). In initial axes, R_s^T R has the
// additional error e_s and d = R_s^T (p - p_s) the error [d]x e_s. Both are assumed independent of
// the current error, which is conservative until the flow is levelled.
MotionEstimate with_initial_pose_error(const MotionEstimate& motion,
                                       const Matrix6d& initial_covariance,
                                       const Eigen::Quaterniond& world_from_initial) {
  const Eigen::Matrix3d R = world_from_initial.conjugate().toRotationMatrix();
  const Eigen::Matrix3d rotation_covariance =
      R * initial_covariance.bottomRightCorner<3, 3>() * R.transpose();
  const Eigen::Matrix3d D = skew(motion.displacement_in_reference);
  MotionEstimate out = motion;
  out.rotation_covariance += rotation_covariance;
  out.displacement_covariance += D * rotation_covariance * D.transpose() +
                                 R * initial_covariance.topLeftCorner<3, 3>() * R.transpose();
  return out;
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

MotionEstimate motion_estimate(const NavigationEstimate& estimate,
                               const Matrix6d& initial_covariance,
                               const RigidTransform& body_from_camera) {
  const RigidTransform world_from_initial = estimate.world_from_initial * body_from_camera;
  const RigidTransform initial_from_camera =
      world_from_initial.inverse() * (estimate.world_from_body * body_from_camera);
  const bool is_fused_without_scale =
      estimate.source == EstimateSource::fused && estimate.scale == ScaleSource::none;
  if (estimate.reference &&
      (estimate.source == EstimateSource::reference || is_fused_without_scale)) {
    const MotionEstimate& since_reference = estimate.reference->motion;
    return estimate.reference->on_first_reference
               ? since_reference
               : relative_to_first_reference(since_reference, initial_from_camera.rotation);
  }
  const MotionEstimate motion = motion_from_initial(estimate, world_from_initial, body_from_camera);
  // the fusion's world is fixed by the first frame: no initial pose error
  return estimate.source == EstimateSource::flow
             ? with_initial_pose_error(motion, initial_covariance, world_from_initial.rotation)
             : motion;
}

}  // namespace stillkite
