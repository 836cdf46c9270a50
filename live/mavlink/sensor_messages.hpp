#pragma once

#include <array>
#include <cstdint>
#include <string_view>

// Sensor messages: fields, units and order of the MAVLink common definitions.

namespace stillkite::mavlink {

/// Attitude w, x, y, z: north-east-down from body (forward, right, down); rates in rad/s.
struct AttitudeQuaternion {
  static constexpr std::uint32_t kId = 31;
  static constexpr std::string_view kName = "ATTITUDE_QUATERNION";

  std::uint32_t time_boot_ms = 0;
  float q1 = 0, q2 = 0, q3 = 0, q4 = 0, rollspeed = 0, pitchspeed = 0, yawspeed = 0;
  std::array<float, 4> repr_offset_q{};

  static constexpr void fields(auto& self, auto&& field) {
    field("time_boot_ms", self.time_boot_ms);
    field("q1", self.q1);
    field("q2", self.q2);
    field("q3", self.q3);
    field("q4", self.q4);
    field("rollspeed", self.rollspeed);
    field("pitchspeed", self.pitchspeed);
    field("yawspeed", self.yawspeed);
    field.extensions();
    field("repr_offset_q", self.repr_offset_q);
  }
};

/// IMU in m/s^2 and rad/s; body axes forward, right, down.
struct HighresImu {
  static constexpr std::uint32_t kId = 105;
  static constexpr std::string_view kName = "HIGHRES_IMU";

  std::uint64_t time_usec = 0;
  float xacc = 0, yacc = 0, zacc = 0, xgyro = 0, ygyro = 0, zgyro = 0, xmag = 0, ymag = 0, zmag = 0,
        abs_pressure = 0, diff_pressure = 0, pressure_alt = 0, temperature = 0;
  std::uint16_t fields_updated = 0;
  std::uint8_t id = 0;

  static constexpr void fields(auto& self, auto&& field) {
    field("time_usec", self.time_usec);
    field("xacc", self.xacc);
    field("yacc", self.yacc);
    field("zacc", self.zacc);
    field("xgyro", self.xgyro);
    field("ygyro", self.ygyro);
    field("zgyro", self.zgyro);
    field("xmag", self.xmag);
    field("ymag", self.ymag);
    field("zmag", self.zmag);
    field("abs_pressure", self.abs_pressure);
    field("diff_pressure", self.diff_pressure);
    field("pressure_alt", self.pressure_alt);
    field("temperature", self.temperature);
    field("fields_updated", self.fields_updated);
    field.extensions();
    field("id", self.id);
  }
};

/// First IMU: mG, mrad/s, mgauss; body axes forward, right, down.
struct ScaledImu {
  static constexpr std::uint32_t kId = 26;
  static constexpr std::string_view kName = "SCALED_IMU";

  std::uint32_t time_boot_ms = 0;
  std::int16_t xacc = 0, yacc = 0, zacc = 0, xgyro = 0, ygyro = 0, zgyro = 0, xmag = 0, ymag = 0,
               zmag = 0, temperature = 0;

  static constexpr void fields(auto& self, auto&& field) {
    field("time_boot_ms", self.time_boot_ms);
    field("xacc", self.xacc);
    field("yacc", self.yacc);
    field("zacc", self.zacc);
    field("xgyro", self.xgyro);
    field("ygyro", self.ygyro);
    field("zgyro", self.zgyro);
    field("xmag", self.xmag);
    field("ymag", self.ymag);
    field("zmag", self.zmag);
    field.extensions();
    field("temperature", self.temperature);
  }
};

/// IMU number 2, as ScaledImu.
struct ScaledImu2 : ScaledImu {
  static constexpr std::uint32_t kId = 116;
  static constexpr std::string_view kName = "SCALED_IMU2";
};

/// IMU number 3, as ScaledImu.
struct ScaledImu3 : ScaledImu {
  static constexpr std::uint32_t kId = 129;
  static constexpr std::string_view kName = "SCALED_IMU3";
};

/// IMU in raw units; ArduPilot sends mG and mrad/s.
struct RawImu {
  static constexpr std::uint32_t kId = 27;
  static constexpr std::string_view kName = "RAW_IMU";

  std::uint64_t time_usec = 0;
  std::int16_t xacc = 0, yacc = 0, zacc = 0, xgyro = 0, ygyro = 0, zgyro = 0, xmag = 0, ymag = 0,
               zmag = 0;
  std::uint8_t id = 0;
  std::int16_t temperature = 0;

  static constexpr void fields(auto& self, auto&& field) {
    field("time_usec", self.time_usec);
    field("xacc", self.xacc);
    field("yacc", self.yacc);
    field("zacc", self.zacc);
    field("xgyro", self.xgyro);
    field("ygyro", self.ygyro);
    field("zgyro", self.zgyro);
    field("xmag", self.xmag);
    field("ymag", self.ymag);
    field("zmag", self.zmag);
    field.extensions();
    field("id", self.id);
    field("temperature", self.temperature);
  }
};

/// Range finder, cm.
struct DistanceSensor {
  static constexpr std::uint32_t kId = 132;
  static constexpr std::string_view kName = "DISTANCE_SENSOR";

  std::uint32_t time_boot_ms = 0;
  std::uint16_t min_distance = 0, max_distance = 0, current_distance = 0;
  std::uint8_t type = 0, id = 0, orientation = 0, covariance = 0;
  float horizontal_fov = 0, vertical_fov = 0;
  std::array<float, 4> quaternion{};
  std::uint8_t signal_quality = 0;

  static constexpr void fields(auto& self, auto&& field) {
    field("time_boot_ms", self.time_boot_ms);
    field("min_distance", self.min_distance);
    field("max_distance", self.max_distance);
    field("current_distance", self.current_distance);
    field("type", self.type);
    field("id", self.id);
    field("orientation", self.orientation);
    field("covariance", self.covariance);
    field.extensions();
    field("horizontal_fov", self.horizontal_fov);
    field("vertical_fov", self.vertical_fov);
    field("quaternion", self.quaternion);
    field("signal_quality", self.signal_quality);
  }
};

/// Position estimate of the autopilot; relative_alt in mm above the home position.
struct GlobalPositionInt {
  static constexpr std::uint32_t kId = 33;
  static constexpr std::string_view kName = "GLOBAL_POSITION_INT";

  std::uint32_t time_boot_ms = 0;
  std::int32_t lat = 0, lon = 0, alt = 0, relative_alt = 0;
  std::int16_t vx = 0, vy = 0, vz = 0;
  std::uint16_t hdg = 0;

  static constexpr void fields(auto& self, auto&& field) {
    field("time_boot_ms", self.time_boot_ms);
    field("lat", self.lat);
    field("lon", self.lon);
    field("alt", self.alt);
    field("relative_alt", self.relative_alt);
    field("vx", self.vx);
    field("vy", self.vy);
    field("vz", self.vz);
    field("hdg", self.hdg);
  }
};

}  // namespace stillkite::mavlink
