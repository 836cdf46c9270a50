#include "app/run_record.hpp"

namespace stillkite {
namespace {

TrueState true_state(const GroundTruth& truth, Timestamp stamp) {
  const double tolerance_s = EvaluationOptions{}.tolerance_s;
  TrueState state;
  if (const auto pose = pose_at(truth.poses, stamp, tolerance_s)) {
    state.position_m = pose->translation;
    if (truth.has_attitude) state.world_from_body = pose->rotation;
  }
  state.velocity_in_world_m_s = velocity_at(truth.velocities, stamp, tolerance_s);
  return state;
}

}  // namespace

void RunRecord::add(const NavigationEstimate& estimate, const FlightInputs& inputs) {
  // Rotation since the previous frame that the images have measured.
  const auto& reference = estimate.reference;
  const std::optional<Eigen::Vector3d>& rate_in_camera_rad_s =
      reference ? reference->measured_rate_in_camera_rad_s : estimate.measured_rate_in_camera_rad_s;
  if (!inputs.sensors.angular_rate_in_body_rad_s.stamps.empty() && tally.last &&
      rate_in_camera_rad_s) {
    const Timestamp previous = tally.last->stamp;
    rotations.push_back({previous, estimate.stamp,
                         seconds_between(previous, estimate.stamp) *
                             (inputs.body_from_camera.rotation * *rate_in_camera_rad_s)});
  }
  charts.add(estimate, true_state(inputs.truth, estimate.stamp));
  if (!inputs.truth.empty()) motions.push_back(evaluated_motion(estimate));
  if (inputs.truth.has_attitude) {
    reference_errors.add(estimate, inputs.truth.poses, inputs.body_from_camera,
                         EvaluationOptions{}.tolerance_s);
  }
  tally.add(estimate);
}

}  // namespace stillkite
