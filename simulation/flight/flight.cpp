#include "simulation/flight/flight.hpp"

#include <cmath>
#include <numbers>
#include <string>

#include "geometry/angle.hpp"
#include "geometry/gravity.hpp"
#include "simulation/random.hpp"

namespace stillkite {
namespace {

// Sines with periods of 4 to 40 s and amplitudes ~ sqrt(period), scaled to the given RMS.
std::vector<Signal::Sine> random_sines(double rms, Random random) {
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

// Signal from `start` to `start + displacement`; a linear term cancels the sines at both ends.
Signal exact_at_ends(double start, double displacement, double duration_s,
                     std::vector<Signal::Sine> sines) {
  Signal signal{0, 0, std::move(sines)};
  const double first = signal.at(0).value;
  const double last = signal.at(duration_s).value;
  signal.offset = start - first;
  signal.slope = (displacement + first - last) / duration_s;
  return signal;
}

// Adds displacement / 2 (1 - cos(2 pi t / T)).
void add_out_and_back(double displacement, double duration_s, Signal& signal) {
  signal.offset += displacement / 2;
  signal.sines.push_back(
      {-displacement / 2, 2 * std::numbers::pi / duration_s, std::numbers::pi / 2});
}

// Adds x = v/w (sin(psi + wt) - sin psi), y = v/w (cos psi - cos(psi + wt)) and sets the roll to
// the bank angle -atan(v w / g).
void add_coordinated_turn(const FlightConfig& config, Trajectory& trajectory) {
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
    throw InputError("flight.climb_m: " + std::to_string(config.climb_m) + " from height_m " +
                     std::to_string(config.height_m) +
                     " reaches the ground; increase climb_m or height_m, or reduce sway_m");
  }
  if (is_turn && config.turn_rate_deg_s == 0) {
    throw InputError("flight.turn_rate_deg_s: 0 is invalid for shape turn; set a rate or use line");
  }
  const double heading = config.heading_deg * kDegree;
  const double x_m = config.forward_m * std::cos(heading) - config.left_m * std::sin(heading);
  const double y_m = config.forward_m * std::sin(heading) + config.left_m * std::cos(heading);
  const auto sway = [&](double rms, std::uint64_t axis) {
    return random_sines(rms, Random(seed, 1000 + axis));
  };
  const double tilt_rms = config.tilt_sway_deg * kDegree;
  const double T = config.duration_s;
  Trajectory trajectory{.x_m = exact_at_ends(0, is_line ? x_m : 0, T, sway(config.sway_m, 0)),
                        .y_m = exact_at_ends(0, is_line ? y_m : 0, T, sway(config.sway_m, 1)),
                        .z_m = exact_at_ends(config.height_m, is_line ? config.climb_m : 0, T,
                                             sway(config.sway_m, 2)),
                        .yaw_rad = {heading, 0, sway(config.yaw_sway_deg * kDegree, 3)},
                        .pitch_rad = {config.pitch_deg * kDegree, 0, sway(tilt_rms, 4)},
                        .roll_rad = {config.roll_deg * kDegree, 0, sway(tilt_rms, 5)}};
  if (is_turn) add_coordinated_turn(config, trajectory);
  if (config.shape == FlightShape::out_and_back) {
    add_out_and_back(x_m, T, trajectory.x_m);
    add_out_and_back(y_m, T, trajectory.y_m);
    add_out_and_back(config.climb_m, T, trajectory.z_m);
  }
  return trajectory;
}

}  // namespace stillkite
