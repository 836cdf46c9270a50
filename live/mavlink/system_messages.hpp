#pragma once

#include <array>
#include <cstdint>
#include <string_view>

// Messages of a link: fields, units and order of the MAVLink common definitions.

namespace stillkite::mavlink {

/// Presence and kind of a component.
struct Heartbeat {
  static constexpr std::uint32_t kId = 0;
  static constexpr std::string_view kName = "HEARTBEAT";

  std::uint8_t type = 0, autopilot = 0, base_mode = 0;
  std::uint32_t custom_mode = 0;
  std::uint8_t system_status = 0, mavlink_version = 0;

  static constexpr void fields(auto& self, auto&& field) {
    field("type", self.type);
    field("autopilot", self.autopilot);
    field("base_mode", self.base_mode);
    field("custom_mode", self.custom_mode);
    field("system_status", self.system_status);
    field("mavlink_version", self.mavlink_version);
  }
};

/// Clock comparison, ns. A request has tc1 = 0; the reply repeats ts1 and adds tc1.
struct Timesync {
  static constexpr std::uint32_t kId = 111;
  static constexpr std::string_view kName = "TIMESYNC";

  std::int64_t tc1 = 0, ts1 = 0;
  std::uint8_t target_system = 0, target_component = 0;

  static constexpr void fields(auto& self, auto&& field) {
    field("tc1", self.tc1);
    field("ts1", self.ts1);
    field.extensions();
    field("target_system", self.target_system);
    field("target_component", self.target_component);
  }
};

/// Text for the operator, zero-padded.
struct Statustext {
  static constexpr std::uint32_t kId = 253;
  static constexpr std::string_view kName = "STATUSTEXT";

  std::uint8_t severity = 0;
  std::array<char, 50> text{};
  std::uint16_t id = 0;
  std::uint8_t chunk_seq = 0;

  static constexpr void fields(auto& self, auto&& field) {
    field("severity", self.severity);
    field("text", self.text);
    field.extensions();
    field("id", self.id);
    field("chunk_seq", self.chunk_seq);
  }
};

/// Geodetic origin of the local frame: 1e-7 deg, 1e-7 deg, mm.
struct SetGpsGlobalOrigin {
  static constexpr std::uint32_t kId = 48;
  static constexpr std::string_view kName = "SET_GPS_GLOBAL_ORIGIN";

  std::uint8_t target_system = 0;
  std::int32_t latitude = 0, longitude = 0, altitude = 0;
  std::uint64_t time_usec = 0;

  static constexpr void fields(auto& self, auto&& field) {
    field("target_system", self.target_system);
    field("latitude", self.latitude);
    field("longitude", self.longitude);
    field("altitude", self.altitude);
    field.extensions();
    field("time_usec", self.time_usec);
  }
};

}  // namespace stillkite::mavlink
