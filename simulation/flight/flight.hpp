#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <utility>

#include "geometry/fields.hpp"
#include "simulation/flight/trajectory.hpp"

namespace stillkite {

enum class FlightShape { line, turn, out_and_back, hand };

template <>
struct EnumNames<FlightShape> {
  static constexpr auto value = std::to_array<std::pair<FlightShape, std::string_view>>(
      {{FlightShape::line, "line"},
       {FlightShape::turn, "turn"},
       {FlightShape::out_and_back, "out_and_back"},
       {FlightShape::hand, "hand"}});
};

/// Defaults: the flow paper's flight (section 5) of 150 s at a height of 400 m; displacement 1 km
/// forward, 100 m left, 50 m down; random roll and pitch of 1.2 degrees RMS.
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
  double hand_m = 0.03;
  double hand_deg = 2.0;
  double rest_s = 0;

  static void fields(auto& self, auto&& field) {
    field("shape", self.shape,
          "line: constant mean velocity, or hovering; turn: coordinated turn, which ignores "
          "forward_m, left_m and climb_m; out_and_back: displacement reached at half time, return "
          "to the initial position, constant mean heading; hand: sway about the initial position "
          "with hand motion, ignores forward_m, left_m and climb_m");
    field("duration_s", self.duration_s, Range{0.01, 36000}, "from the first frame to the last");
    field("height_m", self.height_m, kPositive, "initial height of the body over z = 0");
    field("heading_deg", self.heading_deg, kAny, "initial yaw");
    field("pitch_deg", self.pitch_deg, Range{-80, 80}, "mean pitch, nose down is positive");
    field("roll_deg", self.roll_deg, Range{-80, 80}, "mean roll; a turn uses its bank angle");
    field("forward_m", self.forward_m, kAny, "displacement along the heading; 0: hovering");
    field("left_m", self.left_m, kAny, "displacement to the left of the heading");
    field("climb_m", self.climb_m, kAny, "upward displacement; negative: descent");
    field("speed_m_s", self.speed_m_s, kPositive, "turn: speed along the circle");
    field("turn_rate_deg_s", self.turn_rate_deg_s, kAny, "turn: yaw rate, left is positive, not 0");
    field("sway_m", self.sway_m, kNonNegative, "random translation, RMS per axis");
    field("tilt_sway_deg", self.tilt_sway_deg, Range{0, 30}, "random roll and pitch, RMS");
    field("yaw_sway_deg", self.yaw_sway_deg, Range{0, 90}, "random yaw, RMS");
    field("hand_m", self.hand_m, kNonNegative, "hand: translation at 0.3 to 3 Hz, RMS per axis");
    field("hand_deg", self.hand_deg, Range{0, 30}, "hand: rotation at 0.3 to 3 Hz, RMS per axis");
    field("rest_s", self.rest_s, kNonNegative,
          "initial rest, without random motion; full speed 1 s later; 0: starts in motion");
  }
};

/// Analytic trajectory from x = y = 0 plus a random part: sines with periods of 4 to 40 s from the
/// seed, by hand also of 0.3 to 3 Hz. The random translation is zero at both ends, so that the
/// displacement is exact. Throws InputError if the path reaches the ground, a turn has yaw rate 0
/// or the rest lasts for the whole flight.
[[nodiscard]] Trajectory make_trajectory(const FlightConfig& config, std::uint64_t seed);

}  // namespace stillkite
