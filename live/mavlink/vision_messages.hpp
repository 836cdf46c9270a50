#pragma once

#include <array>
#include <cstdint>
#include <string_view>

// Messages to the autopilot: fields, units and order of the MAVLink common definitions.

namespace stillkite::mavlink {

/// Pose in frame_id; velocity and angular rate in child_frame_id. Covariances: upper right
/// triangle, row by row.
struct Odometry {
  static constexpr std::uint32_t kId = 331;
  static constexpr std::string_view kName = "ODOMETRY";

  std::uint64_t time_usec = 0;
  std::uint8_t frame_id = 0, child_frame_id = 0;
  float x = 0, y = 0, z = 0;
  std::array<float, 4> q{};
  float vx = 0, vy = 0, vz = 0, rollspeed = 0, pitchspeed = 0, yawspeed = 0;
  std::array<float, 21> pose_covariance{};
  std::array<float, 21> velocity_covariance{};
  std::uint8_t reset_counter = 0, estimator_type = 0;
  std::int8_t quality = 0;

  static constexpr void fields(auto& self, auto&& field) {
    field("time_usec", self.time_usec);
    field("frame_id", self.frame_id);
    field("child_frame_id", self.child_frame_id);
    field("x", self.x);
    field("y", self.y);
    field("z", self.z);
    field("q", self.q);
    field("vx", self.vx);
    field("vy", self.vy);
    field("vz", self.vz);
    field("rollspeed", self.rollspeed);
    field("pitchspeed", self.pitchspeed);
    field("yawspeed", self.yawspeed);
    field("pose_covariance", self.pose_covariance);
    field("velocity_covariance", self.velocity_covariance);
    field.extensions();
    field("reset_counter", self.reset_counter);
    field("estimator_type", self.estimator_type);
    field("quality", self.quality);
  }
};

/// Optical flow of a nadir sensor; flow in 0.1 px and flow_rate in rad/s about the body axes.
struct OpticalFlow {
  static constexpr std::uint32_t kId = 100;
  static constexpr std::string_view kName = "OPTICAL_FLOW";

  std::uint64_t time_usec = 0;
  std::uint8_t sensor_id = 0;
  std::int16_t flow_x = 0, flow_y = 0;
  float flow_comp_m_x = 0, flow_comp_m_y = 0;
  std::uint8_t quality = 0;
  float ground_distance = 0, flow_rate_x = 0, flow_rate_y = 0;

  static constexpr void fields(auto& self, auto&& field) {
    field("time_usec", self.time_usec);
    field("sensor_id", self.sensor_id);
    field("flow_x", self.flow_x);
    field("flow_y", self.flow_y);
    field("flow_comp_m_x", self.flow_comp_m_x);
    field("flow_comp_m_y", self.flow_comp_m_y);
    field("quality", self.quality);
    field("ground_distance", self.ground_distance);
    field.extensions();
    field("flow_rate_x", self.flow_rate_x);
    field("flow_rate_y", self.flow_rate_y);
  }
};

/// Optical flow of a nadir sensor, integrated over an interval, rad.
struct OpticalFlowRad {
  static constexpr std::uint32_t kId = 106;
  static constexpr std::string_view kName = "OPTICAL_FLOW_RAD";

  std::uint64_t time_usec = 0;
  std::uint8_t sensor_id = 0;
  std::uint32_t integration_time_us = 0;
  float integrated_x = 0, integrated_y = 0, integrated_xgyro = 0, integrated_ygyro = 0,
        integrated_zgyro = 0;
  std::int16_t temperature = 0;
  std::uint8_t quality = 0;
  std::uint32_t time_delta_distance_us = 0;
  float distance = 0;

  static constexpr void fields(auto& self, auto&& field) {
    field("time_usec", self.time_usec);
    field("sensor_id", self.sensor_id);
    field("integration_time_us", self.integration_time_us);
    field("integrated_x", self.integrated_x);
    field("integrated_y", self.integrated_y);
    field("integrated_xgyro", self.integrated_xgyro);
    field("integrated_ygyro", self.integrated_ygyro);
    field("integrated_zgyro", self.integrated_zgyro);
    field("temperature", self.temperature);
    field("quality", self.quality);
    field("time_delta_distance_us", self.time_delta_distance_us);
    field("distance", self.distance);
  }
};

/// Position and attitude in the local frame (forward, right, down).
struct VisionPositionEstimate {
  static constexpr std::uint32_t kId = 102;
  static constexpr std::string_view kName = "VISION_POSITION_ESTIMATE";

  std::uint64_t usec = 0;
  float x = 0, y = 0, z = 0, roll = 0, pitch = 0, yaw = 0;
  std::array<float, 21> covariance{};
  std::uint8_t reset_counter = 0;

  static constexpr void fields(auto& self, auto&& field) {
    field("usec", self.usec);
    field("x", self.x);
    field("y", self.y);
    field("z", self.z);
    field("roll", self.roll);
    field("pitch", self.pitch);
    field("yaw", self.yaw);
    field.extensions();
    field("covariance", self.covariance);
    field("reset_counter", self.reset_counter);
  }
};

/// Velocity in the local frame (forward, right, down).
struct VisionSpeedEstimate {
  static constexpr std::uint32_t kId = 103;
  static constexpr std::string_view kName = "VISION_SPEED_ESTIMATE";

  std::uint64_t usec = 0;
  float x = 0, y = 0, z = 0;
  std::array<float, 9> covariance{};
  std::uint8_t reset_counter = 0;

  static constexpr void fields(auto& self, auto&& field) {
    field("usec", self.usec);
    field("x", self.x);
    field("y", self.y);
    field("z", self.z);
    field.extensions();
    field("covariance", self.covariance);
    field("reset_counter", self.reset_counter);
  }
};

}  // namespace stillkite::mavlink
