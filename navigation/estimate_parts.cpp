#include "navigation/estimate_parts.hpp"

#include <algorithm>
#include <functional>

namespace stillkite {
namespace {

MetricState metric_state(const NavigationEstimate& aligned) {
  return {.position_in_world_m = aligned.world_from_body.translation,
          .position_covariance_m2 = aligned.pose_covariance.topLeftCorner<3, 3>(),
          .velocity_in_world_m_s = aligned.velocity_in_world_m_s,
          .velocity_in_camera_m_s = aligned.twist_in_camera.velocity_m_s,
          .velocity_covariance_m2_s2 = aligned.twist_covariance.topLeftCorner<3, 3>(),
          .scale = aligned.scale,
          .scale_age_s = aligned.scale_age_s};
}

RelativeState relative_state(const NavigationEstimate& aligned,
                             const RigidTransform& body_from_camera) {
  const double initial_height = (aligned.world_from_initial * body_from_camera).translation.z();
  return {.position_in_world_heights = aligned.world_from_body.translation / initial_height,
          .velocity_in_world_heights_s = aligned.velocity_in_world_m_s / initial_height};
}

ReferencePose reference_pose(const ReferenceReport& report) {
  const MotionEstimate& motion = report.motion;
  ReferencePose out{.stamp = report.reference_stamp,
                    .on_first_reference = report.on_first_reference,
                    .reference_from_camera = motion.reference_from_camera,
                    .rotation_covariance_rad2 = motion.rotation_covariance,
                    .displacement = motion.displacement_kind};
  const bool is_metric = motion.displacement_kind == DisplacementKind::metric;
  if (!is_metric && motion.displacement_kind != DisplacementKind::direction) return out;
  (is_metric ? out.displacement_in_reference_m : out.direction_in_reference) =
      motion.displacement_in_reference;
  out.displacement_covariance = motion.displacement_covariance;
  return out;
}

}  // namespace

NavigationEstimate make_estimate(const Frame& frame, const RigidTransform& body_from_camera,
                                 const EstimateParts& parts) {
  const RigidTransform camera_from_body = body_from_camera.inverse();
  const ScaledPose& camera = parts.camera;
  const bool is_metric = camera.scale != ScaleSource::none;
  return {.stamp = frame.stamp,
          .frame_index = frame.index,
          .verdict = parts.verdict,
          .source = parts.source,
          .world_from_body = camera.pose.world_from_camera * camera_from_body,
          .world_from_initial = parts.world_from_initial_camera * camera_from_body,
          .pose_covariance = camera.pose.covariance,
          .twist_in_camera = parts.twist_in_camera,
          .twist_covariance = parts.twist_covariance,
          .velocity_in_world_m_s = parts.velocity_in_world_m_s,
          .scale = camera.scale,
          .scale_age_s = is_metric ? seconds_between(camera.scale_stamp, frame.stamp) : 0,
          .new_keyframe = parts.new_keyframe,
          .quality = parts.quality};
}

NavigationEstimate with_both_reports(NavigationEstimate estimate, const NavigationEstimate& flow,
                                     const NavigationEstimate& reference) {
  estimate.image_shift_px = flow.image_shift_px;
  estimate.reference = reference.reference;
  std::transform(flow.stage_ms.begin(), flow.stage_ms.end(), reference.stage_ms.begin(),
                 estimate.stage_ms.begin(), std::plus<>());
  return estimate;
}

Estimate public_estimate(const NavigationEstimate& estimate,
                         const RigidTransform& body_from_camera) {
  const NavigationEstimate aligned = gravity_aligned(estimate);
  Estimate out{
      .stamp = aligned.stamp,
      .frame_index = aligned.frame_index,
      .verdict = aligned.verdict,
      .source = aligned.source,
      .world_from_body = aligned.world_from_body.rotation,
      .attitude_covariance_rad2 = aligned.pose_covariance.bottomRightCorner<3, 3>(),
      .angular_rate_in_camera_rad_s = aligned.twist_in_camera.angular_rate_rad_s,
      .angular_rate_covariance_rad2_s2 = aligned.twist_covariance.bottomRightCorner<3, 3>()};
  if (aligned.scale != ScaleSource::none) {
    out.metric = metric_state(aligned);
  } else if (aligned.source != EstimateSource::reference) {
    out.relative = relative_state(aligned, body_from_camera);
  }
  if (aligned.reference && aligned.reference->motion.status == EstimateStatus::ok &&
      is_measured(aligned.verdict)) {
    out.reference = reference_pose(*aligned.reference);
  }
  return out;
}

}  // namespace stillkite
