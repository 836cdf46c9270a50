#include "app/autopilot_output.hpp"

#include <utility>

#include "live/mavlink/vision_output.hpp"

namespace stillkite {

void AutopilotOutput::send(const NavigationEstimate& estimate,
                           const RigidTransform& body_from_camera) {
  const std::optional<Timestamp> previous = std::exchange(last_, estimate.stamp);
  const std::uint8_t resets = resets_.update(estimate);
  if (const auto text = verdicts_.update(estimate.stamp, estimate.verdict)) link_.send(*text);
  if (estimate.scale == ScaleSource::none) return;
  const mavlink::BodyState state = mavlink::body_state(estimate, body_from_camera, resets);
  if (config_.odometry) link_.send(mavlink::odometry(state));
  if (config_.vision_position_estimate) link_.send(mavlink::vision_position_estimate(state));
  if (config_.vision_speed_estimate) link_.send(mavlink::vision_speed_estimate(state));
  if (config_.optical_flow) link_.send(mavlink::optical_flow(state));
  if (config_.optical_flow_rad && previous) {
    link_.send(mavlink::optical_flow_rad(state, seconds_between(*previous, state.stamp)));
  }
}

}  // namespace stillkite
