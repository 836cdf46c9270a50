#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "geometry/fields.hpp"
#include "live/tether_config.hpp"

namespace stillkite {

/// Message that carries the IMU: of MAVLink, or a JSON line.
enum class ImuMessage { none, highres, scaled, scaled2, scaled3, raw, json };
template <>
struct EnumNames<ImuMessage> {
  static constexpr auto value =
      std::to_array<std::pair<ImuMessage, std::string_view>>({{ImuMessage::none, "none"},
                                                              {ImuMessage::highres, "HIGHRES_IMU"},
                                                              {ImuMessage::scaled, "SCALED_IMU"},
                                                              {ImuMessage::scaled2, "SCALED_IMU2"},
                                                              {ImuMessage::scaled3, "SCALED_IMU3"},
                                                              {ImuMessage::raw, "RAW_IMU"},
                                                              {ImuMessage::json, "JSON"}});
};

/// Message that carries the attitude.
enum class AttitudeMessage { none, quaternion, json };
template <>
struct EnumNames<AttitudeMessage> {
  // false and true: records of earlier versions
  static constexpr auto value = std::to_array<std::pair<AttitudeMessage, std::string_view>>(
      {{AttitudeMessage::none, "none"},
       {AttitudeMessage::quaternion, "ATTITUDE_QUATERNION"},
       {AttitudeMessage::json, "JSON"},
       {AttitudeMessage::none, "false"},
       {AttitudeMessage::quaternion, "true"}});
};

/// Message that carries the height.
enum class HeightMessage { none, distance_sensor, global_position, json_range, json_height };
template <>
struct EnumNames<HeightMessage> {
  static constexpr auto value = std::to_array<std::pair<HeightMessage, std::string_view>>(
      {{HeightMessage::none, "none"},
       {HeightMessage::distance_sensor, "DISTANCE_SENSOR"},
       {HeightMessage::global_position, "GLOBAL_POSITION_INT"},
       {HeightMessage::json_range, "JSON_RANGE"},
       {HeightMessage::json_height, "JSON_HEIGHT"}});
};

/// Distance of a range finder that looks down.
[[nodiscard]] constexpr bool is_range(HeightMessage message) {
  return message == HeightMessage::distance_sensor || message == HeightMessage::json_range;
}
/// Height relative to an unknown one, as of a barometer.
[[nodiscard]] constexpr bool is_relative_height(HeightMessage message) {
  return message == HeightMessage::global_position || message == HeightMessage::json_height;
}

/// Telemetry that the estimator uses.
struct TelemetryConfig {
  ImuMessage imu = ImuMessage::none;
  AttitudeMessage attitude = AttitudeMessage::none;
  HeightMessage height = HeightMessage::none;
  std::optional<std::string> json;

  [[nodiscard]] bool uses_json() const {
    return imu == ImuMessage::json || attitude == AttitudeMessage::json ||
           height == HeightMessage::json_range || height == HeightMessage::json_height;
  }
  [[nodiscard]] bool uses_mavlink() const {
    return (imu != ImuMessage::none && imu != ImuMessage::json) ||
           attitude == AttitudeMessage::quaternion || height == HeightMessage::distance_sensor ||
           height == HeightMessage::global_position;
  }

  static void fields(auto& self, auto&& field) {
    field("imu", self.imu, "message of the IMU; JSON: lines of live.telemetry.json");
    field("attitude", self.attitude, "message of the attitude");
    field("height", self.height,
          "message of the height: range finder that looks down (DISTANCE_SENSOR, JSON_RANGE), or "
          "relative height as a barometer (relative_alt, JSON_HEIGHT)");
    field("json", self.json,
          "sensor readings as JSON lines: udp://:PORT (listens) or serial:DEVICE:BAUD");
  }
};

/// Messages to the autopilot.
struct MavlinkOutputConfig {
  bool odometry = true;
  bool optical_flow = false;
  bool optical_flow_rad = false;
  bool vision_position_estimate = false;
  bool vision_speed_estimate = false;
  std::optional<std::array<double, 3>> origin;

  static void fields(auto& self, auto&& field) {
    field("odometry", self.odometry, "send ODOMETRY");
    field("optical_flow", self.optical_flow, "send OPTICAL_FLOW with flow_rate (ArduPilot)");
    field("optical_flow_rad", self.optical_flow_rad, "send OPTICAL_FLOW_RAD (PX4)");
    field("vision_position_estimate", self.vision_position_estimate,
          "send VISION_POSITION_ESTIMATE");
    field("vision_speed_estimate", self.vision_speed_estimate, "send VISION_SPEED_ESTIMATE");
    field("origin", self.origin,
          "latitude [deg], longitude [deg], altitude [m]: send SET_GPS_GLOBAL_ORIGIN");
  }
};

/// Connections of a live flight.
struct LiveConfig {
  std::optional<std::string> json;
  std::optional<std::string> mavlink;
  int system_id = 1;
  TelemetryConfig telemetry;
  MavlinkOutputConfig send;
  TetherConfig tether;
  std::optional<std::string> operator_source;
  std::optional<std::string> listen;
  std::optional<std::string> public_host;

  static void fields(auto& self, auto&& field) {
    field("json", self.json, "estimates as JSON lines: - (standard output) or udp://HOST:PORT");
    field("mavlink", self.mavlink,
          "link to the autopilot: udp://:PORT (listens), udp://HOST:PORT or serial:DEVICE:BAUD");
    field("system_id", self.system_id, Range{1, 255}, "MAVLink system id of the vehicle");
    field("telemetry", self.telemetry, "telemetry that the estimator uses");
    field("send", self.send, "messages to the autopilot");
    field("tether", self.tether, "ground station of a tethered drone");
    field("operator", self.operator_source,
          "operator commands as JSON lines: - (standard input) or unix:PATH (datagrams)");
    field("listen", self.listen,
          "operator's page: HOST:PORT, for example 127.0.0.1:8080; other hosts need a token in "
          "STILLKITE_PAGE_TOKEN");
    field("public_host", self.public_host,
          "operator's page: host name of a reverse proxy; needs a token");
  }
};

}  // namespace stillkite
