#include "navigation/motion_from_initial.hpp"

namespace stillkite {
namespace {

EstimateStatus status_of(const NavigationEstimate& estimate) {
  if (is_measured(estimate.verdict)) return EstimateStatus::ok;
  const bool is_predicted =
      estimate.source == EstimateSource::fused && estimate.scale != ScaleSource::none;
  return is_predicted ? EstimateStatus::predicted : EstimateStatus::lost;
}

}  // namespace

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
