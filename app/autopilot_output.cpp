#include "app/autopilot_output.hpp"

#include <utility>

#include "live/mavlink/vision_output.hpp"

namespace stillkite {

void AutopilotOutput::send(const NavigationEstimate& estimate,
                           const RigidTransform& body_from_camera, double focal_length_px) {
  const std::optional<Timestamp> previous = std::exchange(last_, estimate.stamp);
  const std::uint8_t resets = resets_.update(estimate);
  if (const auto text = verdicts_.update(estimate.stamp, estimate.verdict)) link_.send(*text);
  const auto state = mavlink::body_state(estimate, body_from_camera, resets);
  if (!state) return;
  if (config_.odometry) link_.send(mavlink::odometry(*state));
  if (config_.vision_position_estimate) link_.send(mavlink::vision_position_estimate(*state));
  if (config_.vision_speed_estimate) link_.send(mavlink::vision_speed_estimate(*state));
  if (!previous) return;
  const double interval_s = seconds_between(*previous, state->stamp);
  if (config_.optical_flow) {
    const auto flow = mavlink::optical_flow(*state, interval_s, focal_length_px);
    if (flow) link_.send(*flow);
  }
  if (config_.optical_flow_rad) {
    if (const auto flow = mavlink::optical_flow_rad(*state, interval_s)) link_.send(*flow);
  }
}

void AutopilotOutput::report_missing_images(double silence_s) {
  if (const auto text = verdicts_.without_image(silence_s)) link_.send(*text);
}

}  // namespace stillkite
