#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "geometry/fields.hpp"
#include "live/tether_config.hpp"

namespace stillkite {

/// MAVLink message that carries the IMU.
enum class ImuMessage { none, highres, scaled, scaled2, scaled3, raw };
template <>
struct EnumNames<ImuMessage> {
  static constexpr auto value =
      std::to_array<std::pair<ImuMessage, std::string_view>>({{ImuMessage::none, "none"},
                                                              {ImuMessage::highres, "HIGHRES_IMU"},
                                                              {ImuMessage::scaled, "SCALED_IMU"},
                                                              {ImuMessage::scaled2, "SCALED_IMU2"},
                                                              {ImuMessage::scaled3, "SCALED_IMU3"},
                                                              {ImuMessage::raw, "RAW_IMU"}});
};

/// MAVLink message that carries the height.
enum class HeightMessage { none, distance_sensor, global_position };
template <>
struct EnumNames<HeightMessage> {
  static constexpr auto value = std::to_array<std::pair<HeightMessage, std::string_view>>(
      {{HeightMessage::none, "none"},
       {HeightMessage::distance_sensor, "DISTANCE_SENSOR"},
       {HeightMessage::global_position, "GLOBAL_POSITION_INT"}});
};

/// Telemetry that the estimator uses.
struct TelemetryConfig {
  ImuMessage imu = ImuMessage::none;
  bool attitude = false;
  HeightMessage height = HeightMessage::none;

  static void fields(auto& self, auto&& field) {
    field("imu", self.imu, "message of the IMU");
    field("attitude", self.attitude, "use ATTITUDE_QUATERNION");
    field("height", self.height,
          "message of the height: range finder that looks down, or relative_alt as a barometer");
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
