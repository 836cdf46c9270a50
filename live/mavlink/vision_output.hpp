#pragma once

#include <optional>
#include <string_view>

#include "live/mavlink/body_state.hpp"
#include "live/mavlink/system_messages.hpp"
#include "live/mavlink/vision_messages.hpp"

// Messages of an estimate. Frames: MAV_FRAME_LOCAL_FRD for poses, MAV_FRAME_BODY_FRD for velocities
// and rates. Stamps are those of the local monotonic clock, us; TIMESYNC relates it to the
// autopilot's.

namespace stillkite::mavlink {

[[nodiscard]] Odometry odometry(const BodyState& state);
[[nodiscard]] VisionPositionEstimate vision_position_estimate(const BodyState& state);
[[nodiscard]] VisionSpeedEstimate vision_speed_estimate(const BodyState& state);

/// Flow of a sensor that looks along the body's down axis: w_x - v_y / d and w_y + v_x / d, the
/// rotation about the axis that would give the same flow. flow_x and flow_y, for ArduPilot before
/// flow_rate, are the same in 0.1 px of the focal length over the interval since the previous
/// estimate. Empty if the ground distance is unknown.
[[nodiscard]] std::optional<OpticalFlow> optical_flow(const BodyState& state, double interval_s,
                                                      double focal_length_px);
/// The same over the interval since the previous estimate.
[[nodiscard]] std::optional<OpticalFlowRad> optical_flow_rad(const BodyState& state,
                                                             double interval_s);

[[nodiscard]] Heartbeat heartbeat();
[[nodiscard]] SetGpsGlobalOrigin gps_origin(double latitude_deg, double longitude_deg,
                                            double altitude_m, std::uint8_t target_system);

enum class Severity : std::uint8_t { warning = 4, info = 6 };
/// Text of at most 50 bytes; the rest is cut.
[[nodiscard]] Statustext status_text(Severity severity, std::string_view text);

}  // namespace stillkite::mavlink
