#include "navigation/estimate_parts.hpp"

#include <algorithm>
#include <functional>

namespace stillkite {

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
  estimate.image_speed_px_s = flow.image_speed_px_s;
  estimate.image_shift_px = flow.image_shift_px;
  estimate.reference = reference.reference;
  std::transform(flow.stage_ms.begin(), flow.stage_ms.end(), reference.stage_ms.begin(),
                 estimate.stage_ms.begin(), std::plus<>());
  return estimate;
}

}  // namespace stillkite
