#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "geometry/fields.hpp"

namespace stillkite {

enum class TetherFormat {
  fotokite,  ///< lines of the Fotokite ground station
  json,      ///< one JSON object per command
};
template <>
struct EnumNames<TetherFormat> {
  static constexpr auto value = std::to_array<std::pair<TetherFormat, std::string_view>>(
      {{TetherFormat::fotokite, "fotokite"}, {TetherFormat::json, "json"}});
};

/// Connection to the ground station of a tethered drone.
struct TetherConfig {
  std::optional<std::string> port;
  TetherFormat format = TetherFormat::fotokite;
  double m_per_count = 0.00285;
  double length_at_zero_m = 0;
  double dead_zone_counts_s = 5;
  bool invert_elevation = false;
  bool invert_azimuth = false;
  bool invert_yaw = false;
  double reading_latency_s = 0;
  double command_delay_s = 0.02;
  double max_unmeasured_s = 1;
  double max_status_age_s = 2;
  std::vector<double> station_modes{1};
  std::vector<double> flight_modes{2};
  int ignored_flags = 0;

  static void fields(auto& self, auto&& field) {
    field("port", self.port,
          "serial:DEVICE:BAUD of the ground station; null: no tether commands. Each command needs "
          "an operator, see live.operator");
    field("format", self.format,
          "of the commands; telemetry is read as the ground station's lines");
    field("m_per_count", self.m_per_count, kPositive, "tether length of one encoder count");
    field("length_at_zero_m", self.length_at_zero_m, kNonNegative,
          "tether length at relTetherLength 0");
    field("dead_zone_counts_s", self.dead_zone_counts_s, Range{0, 1000},
          "length velocity below which the tether motor stands still; smaller ones are sent as "
          "pulses of it");
    field("invert_elevation", self.invert_elevation,
          "a positive elevation rate decreases the elevation of !Pos");
    field("invert_azimuth", self.invert_azimuth,
          "a positive azimuth rate decreases the azimuth of !Pos");
    field("invert_yaw", self.invert_yaw, "a positive yaw rate is to the right");
    field("reading_latency_s", self.reading_latency_s, Range{0, 1},
          "constant delay from a measurement to the arrival of its line");
    field("command_delay_s", self.command_delay_s, Range{0, 1},
          "time from an image's arrival to the effect of its command");
    field("max_unmeasured_s", self.max_unmeasured_s, Range{0, 10},
          "time without a measured image (verdict ok or still) after which all rates are zero");
    field("max_status_age_s", self.max_status_age_s, Range{0.1, 60},
          "maximum age of !FlightStatus; of !GSStatus, !Pos and !Attitude: hold.max_tether_age_s");
    field("station_modes", self.station_modes, "modes of !GSStatus in which commands are sent");
    field("flight_modes", self.flight_modes, "modes of !FlightStatus in which commands are sent");
    field("ignored_flags", self.ignored_flags, Range{0, 8191},
          "fault bits of !FlightStatus that do not withhold commands");
  }
};

}  // namespace stillkite
