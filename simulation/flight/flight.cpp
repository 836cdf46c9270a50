#include "simulation/flight/flight.hpp"

#include <cmath>
#include <numbers>
#include <string>

#include "geometry/angle.hpp"
#include "geometry/gravity.hpp"
#include "simulation/random.hpp"

namespace stillkite {
namespace {

// Sines of 4 to 40 s, slow ones larger, of the given RMS.
std::vector<Signal::Sine> irregular(double rms, Random random) {
  constexpr int kSines = 8;
  std::vector<Signal::Sine> sines;
  double power = 0;
  for (int k = 0; k < kSines; ++k) {
    const double period_s = 4.0 * std::pow(10.0, (k + random.uniform()) / kSines);
    const double amplitude = std::sqrt(period_s) * random.uniform(0.5, 1.5);
    sines.push_back(
        {amplitude, 2 * std::numbers::pi / period_s, random.uniform(0, 2 * std::numbers::pi)});
    power += 0.5 * amplitude * amplitude;
  }
  for (Signal::Sine& sine : sines) sine.amplitude *= rms / std::sqrt(power);
  return sines;
}

// From start to start + way, whatever the sines do in between.
Signal between(double start, double way, double duration_s, std::vector<Signal::Sine> sines) {
  Signal signal{0, 0, std::move(sines)};
  const double first = signal.at(0).value;
  const double last = signal.at(duration_s).value;
  signal.offset = start - first;
  signal.slope = (way + first - last) / duration_s;
  return signal;
}

// Half of way (1 - cos(2 pi t / T)) on top.
void there_and_back(double way, double duration_s, Signal& signal) {
  signal.offset += way / 2;
  signal.sines.push_back({-way / 2, 2 * std::numbers::pi / duration_s, std::numbers::pi / 2});
}

// x = v/w (sin(psi + wt) - sin psi), y = v/w (cos psi - cos(psi + wt)), banked into the turn.
void turn(const FlightConfig& config, Trajectory& trajectory) {
  const double rate = config.turn_rate_deg_s * kDegree;
  const double heading = config.heading_deg * kDegree;
  const double radius = config.speed_m_s / rate;
  trajectory.x_m.sines.push_back({radius, rate, heading});
  trajectory.x_m.offset -= radius * std::sin(heading);
  trajectory.y_m.sines.push_back({radius, rate, heading - std::numbers::pi / 2});
  trajectory.y_m.offset += radius * std::cos(heading);
  trajectory.yaw_rad.slope = rate;
  trajectory.roll_rad.offset = -std::atan(config.speed_m_s * rate / kGravity_m_s2);
}

}  // namespace

Trajectory make_trajectory(const FlightConfig& config, std::uint64_t seed) {
  const bool is_line = config.shape == FlightShape::line;
  const bool is_turn = config.shape == FlightShape::turn;
  if (!(config.height_m + (is_turn ? 0.0 : config.climb_m) - 3 * config.sway_m > 0)) {
    throw InputError("flight: from height_m " + std::to_string(config.height_m) + " climb_m " +
                     std::to_string(config.climb_m) + " leads into the ground; climb less down");
  }
  if (is_turn && config.turn_rate_deg_s == 0) {
    throw InputError("flight.turn_rate_deg_s: 0 is no turn; give a rate or take shape: line");
  }
  const double heading = config.heading_deg * kDegree;
  const double x_way = config.forward_m * std::cos(heading) - config.left_m * std::sin(heading);
  const double y_way = config.forward_m * std::sin(heading) + config.left_m * std::cos(heading);
  const auto sway = [&](double rms, std::uint64_t axis) {
    return irregular(rms, Random(seed, 1000 + axis));
  };
  const double tilt_rms = config.tilt_sway_deg * kDegree;
  const double T = config.duration_s;
  Trajectory trajectory{
      .x_m = between(0, is_line ? x_way : 0, T, sway(config.sway_m, 0)),
      .y_m = between(0, is_line ? y_way : 0, T, sway(config.sway_m, 1)),
      .z_m = between(config.height_m, is_line ? config.climb_m : 0, T, sway(config.sway_m, 2)),
      .yaw_rad = {heading, 0, sway(config.yaw_sway_deg * kDegree, 3)},
      .pitch_rad = {config.pitch_deg * kDegree, 0, sway(tilt_rms, 4)},
      .roll_rad = {config.roll_deg * kDegree, 0, sway(tilt_rms, 5)}};
  if (is_turn) turn(config, trajectory);
  if (config.shape == FlightShape::out_and_back) {
    there_and_back(x_way, T, trajectory.x_m);
    there_and_back(y_way, T, trajectory.y_m);
    there_and_back(config.climb_m, T, trajectory.z_m);
  }
  return trajectory;
}

}  // namespace stillkite
