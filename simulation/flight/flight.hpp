#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <utility>

#include "geometry/fields.hpp"
#include "simulation/flight/trajectory.hpp"

namespace stillkite {

enum class FlightShape { line, turn, out_and_back };

template <>
struct EnumNames<FlightShape> {
  static constexpr auto value = std::to_array<std::pair<FlightShape, std::string_view>>(
      {{FlightShape::line, "line"},
       {FlightShape::turn, "turn"},
       {FlightShape::out_and_back, "out_and_back"}});
};

/// The defaults are the flow paper's flight (section 5): 150 s, 400 m high, 1 km ahead, 100 m
/// aside, 50 m down, with irregular roll and pitch of a degree or two.
struct FlightConfig {
  FlightShape shape = FlightShape::line;
  double duration_s = 150;
  double height_m = 400;
  double heading_deg = 0;
  double pitch_deg = 0;
  double roll_deg = 0;
  double forward_m = 1000;
  double left_m = 100;
  double climb_m = -50;
  double speed_m_s = 10;
  double turn_rate_deg_s = 6;
  double sway_m = 1.0;
  double tilt_sway_deg = 1.2;
  double yaw_sway_deg = 2.0;

  static void fields(auto& self, auto&& field) {
    field("shape", self.shape,
          "line: straight ahead or hovering; turn: a coordinated turn, of which the ways forward, "
          "left and up tell nothing; out_and_back: that far at half time, home at the end, always "
          "looking ahead");
    field("duration_s", self.duration_s, Range{0.01, 36000}, "from the first frame to the last");
    field("height_m", self.height_m, kPositive, "of the body over z = 0 at the start");
    field("heading_deg", self.heading_deg, kAny, "yaw at the start");
    field("pitch_deg", self.pitch_deg, Range{-80, 80}, "mean pitch, nose down is positive");
    field("roll_deg", self.roll_deg, Range{-80, 80}, "mean roll of a line");
    field("forward_m", self.forward_m, kAny, "way along the heading; 0 hovers");
    field("left_m", self.left_m, kAny, "way to the left of the heading");
    field("climb_m", self.climb_m, kAny, "way up, descents are negative");
    field("speed_m_s", self.speed_m_s, kPositive, "turn: speed along the circle");
    field("turn_rate_deg_s", self.turn_rate_deg_s, kAny, "turn: to the left if positive, not 0");
    field("sway_m", self.sway_m, kNotNegative, "irregular motion, RMS an axis");
    field("tilt_sway_deg", self.tilt_sway_deg, Range{0, 30}, "irregular roll and pitch, RMS");
    field("yaw_sway_deg", self.yaw_sway_deg, Range{0, 90}, "irregular yaw, RMS");
  }
};

/// The irregular part (sines of 4 to 40 s) comes from the seed. Of the position it vanishes at both
/// ends but in a turn, so that start and way are exact. Starts at x = y = 0.
/// Throws InputError if the way leads into the ground or a turn does not turn.
[[nodiscard]] Trajectory make_trajectory(const FlightConfig& config, std::uint64_t seed);

}  // namespace stillkite
