#include "live/mavlink/vision_output.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "geometry/euler.hpp"

namespace stillkite::mavlink {
namespace {

// Enumerators of MAVLink.
constexpr std::uint8_t kLocalFrd = 20, kBodyFrd = 12;  // MAV_FRAME
constexpr std::uint8_t kEstimatorVision = 2;           // MAV_ESTIMATOR_TYPE
constexpr std::uint8_t kOnboardController = 18;        // MAV_TYPE
constexpr std::uint8_t kInvalidAutopilot = 8;          // MAV_AUTOPILOT
constexpr std::uint8_t kActive = 4;                    // MAV_STATE
constexpr std::uint8_t kMavlinkVersion = 3;
constexpr std::uint8_t kMaxFlowQuality = 255;

std::uint64_t to_us(Timestamp stamp) {
  return static_cast<std::uint64_t>(stamp.ns / 1000);
}

std::array<float, 21> upper_triangle(const Matrix6d& P) {
  std::array<float, 21> out{};
  std::size_t i = 0;
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) out[i++] = static_cast<float>(P(row, column));
  }
  return out;
}

std::uint8_t flow_quality(const BodyState& state) {
  return static_cast<std::uint8_t>(state.quality * kMaxFlowQuality / 100);
}

// Rotation about the body's x and y axes with the same flow as the motion, rad/s.
Eigen::Vector2d flow_rate_rad_s(const BodyState& state) {
  const Eigen::Vector3d& v = state.velocity_in_body_m_s;
  const Eigen::Vector3d& w = state.angular_rate_in_body_rad_s;
  const double d = state.ground_distance_m.value();
  return {w.x() - v.y() / d, w.y() + v.x() / d};
}

std::int16_t to_decipixels(double pixels) {
  using Limits = std::numeric_limits<std::int16_t>;
  return static_cast<std::int16_t>(
      std::lround(std::clamp(10 * pixels, double{Limits::min()}, double{Limits::max()})));
}

}  // namespace

Odometry odometry(const BodyState& state) {
  const Eigen::Vector3f position = state.position_in_local_m.cast<float>();
  const Eigen::Quaternionf q = state.local_from_body.cast<float>();
  const Eigen::Vector3f velocity = state.velocity_in_body_m_s.cast<float>();
  const Eigen::Vector3f rate = state.angular_rate_in_body_rad_s.cast<float>();
  return {.time_usec = to_us(state.stamp),
          .frame_id = kLocalFrd,
          .child_frame_id = kBodyFrd,
          .x = position.x(),
          .y = position.y(),
          .z = position.z(),
          .q = {q.w(), q.x(), q.y(), q.z()},
          .vx = velocity.x(),
          .vy = velocity.y(),
          .vz = velocity.z(),
          .rollspeed = rate.x(),
          .pitchspeed = rate.y(),
          .yawspeed = rate.z(),
          .pose_covariance = upper_triangle(state.pose_covariance),
          .velocity_covariance = upper_triangle(state.twist_covariance),
          .reset_counter = state.reset_counter,
          .estimator_type = kEstimatorVision,
          .quality = state.quality};
}

VisionPositionEstimate vision_position_estimate(const BodyState& state) {
  const Eigen::Vector3f position = state.position_in_local_m.cast<float>();
  const EulerAngles angles = to_euler(state.local_from_body);
  return {.usec = to_us(state.stamp),
          .x = position.x(),
          .y = position.y(),
          .z = position.z(),
          .roll = static_cast<float>(angles.roll_rad),
          .pitch = static_cast<float>(angles.pitch_rad),
          .yaw = static_cast<float>(angles.yaw_rad),
          .covariance = upper_triangle(state.pose_covariance),
          .reset_counter = state.reset_counter};
}

VisionSpeedEstimate vision_speed_estimate(const BodyState& state) {
  const Eigen::Matrix3d R = state.local_from_body.toRotationMatrix();
  const Eigen::Vector3f velocity = (R * state.velocity_in_body_m_s).cast<float>();
  VisionSpeedEstimate out{.usec = to_us(state.stamp),
                          .x = velocity.x(),
                          .y = velocity.y(),
                          .z = velocity.z(),
                          .reset_counter = state.reset_counter};
  const Eigen::Matrix<float, 3, 3, Eigen::RowMajor> P =
      (R * state.twist_covariance.topLeftCorner<3, 3>() * R.transpose()).cast<float>();
  std::ranges::copy(std::span(P.data(), out.covariance.size()), out.covariance.begin());
  return out;
}

std::optional<OpticalFlow> optical_flow(const BodyState& state, double interval_s,
                                        double focal_length_px) {
  if (!state.ground_distance_m) return std::nullopt;
  const Eigen::Vector2d rate_rad_s = flow_rate_rad_s(state);
  const Eigen::Vector2d flow_px = focal_length_px * interval_s * rate_rad_s;
  const Eigen::Vector2f flow = rate_rad_s.cast<float>();
  const Eigen::Vector3f v = state.velocity_in_body_m_s.cast<float>();
  return OpticalFlow{.time_usec = to_us(state.stamp),
                     .flow_x = to_decipixels(flow_px.x()),
                     .flow_y = to_decipixels(flow_px.y()),
                     .flow_comp_m_x = v.x(),
                     .flow_comp_m_y = v.y(),
                     .quality = flow_quality(state),
                     .ground_distance = static_cast<float>(*state.ground_distance_m),
                     .flow_rate_x = flow.x(),
                     .flow_rate_y = flow.y()};
}

std::optional<OpticalFlowRad> optical_flow_rad(const BodyState& state, double interval_s) {
  if (!state.ground_distance_m) return std::nullopt;
  const Eigen::Vector2f flow = (interval_s * flow_rate_rad_s(state)).cast<float>();
  const Eigen::Vector3f rotation = (interval_s * state.angular_rate_in_body_rad_s).cast<float>();
  return OpticalFlowRad{
      .time_usec = to_us(state.stamp),
      .integration_time_us = static_cast<std::uint32_t>(std::lround(1e6 * interval_s)),
      .integrated_x = flow.x(),
      .integrated_y = flow.y(),
      .integrated_xgyro = rotation.x(),
      .integrated_ygyro = rotation.y(),
      .integrated_zgyro = rotation.z(),
      .quality = flow_quality(state),
      .distance = static_cast<float>(*state.ground_distance_m)};
}

Heartbeat heartbeat() {
  return {.type = kOnboardController,
          .autopilot = kInvalidAutopilot,
          .system_status = kActive,
          .mavlink_version = kMavlinkVersion};
}

SetGpsGlobalOrigin gps_origin(double latitude_deg, double longitude_deg, double altitude_m,
                              std::uint8_t target_system) {
  return {.target_system = target_system,
          .latitude = static_cast<std::int32_t>(std::lround(1e7 * latitude_deg)),
          .longitude = static_cast<std::int32_t>(std::lround(1e7 * longitude_deg)),
          .altitude = static_cast<std::int32_t>(std::lround(1e3 * altitude_m))};
}

Statustext status_text(Severity severity, std::string_view text) {
  Statustext out{.severity = static_cast<std::uint8_t>(severity)};
  std::ranges::copy(text.substr(0, out.text.size()), out.text.begin());
  return out;
}

}  // namespace stillkite::mavlink
