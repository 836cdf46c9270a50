#include "simulation/flight/flight.hpp"

#include <cmath>
#include <numbers>
#include <string>

#include "geometry/angle.hpp"
#include "geometry/gravity.hpp"
#include "simulation/random.hpp"

namespace stillkite {
namespace {

// Sines with periods of one decade and amplitudes ~ sqrt(period), scaled to the given RMS.
std::vector<Signal::Sine> random_sines(double rms, double shortest_period_s, Random random) {
  constexpr int kSines = 8;
  std::vector<Signal::Sine> sines;
  double power = 0;
  for (int k = 0; k < kSines; ++k) {
    const double period_s = shortest_period_s * std::pow(10.0, (k + random.uniform()) / kSines);
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

// Throws InputError.
void check_shape(const FlightConfig& config) {
  const bool is_turn = config.shape == FlightShape::turn;
  const bool is_hand = config.shape == FlightShape::hand;
  const double climb_m = is_turn || is_hand ? 0.0 : config.climb_m;
  const double random_m = config.sway_m + (is_hand ? config.hand_m : 0.0);
  if ((is_turn || is_hand) && !(config.height_m - 3 * random_m > 0)) {
    throw InputError("flight.height_m: " + std::to_string(config.height_m) +
                     " is below three times the random translation; increase it, or reduce sway_m" +
                     (is_hand ? " or hand_m" : ""));
  }
  if (!(config.height_m + climb_m - 3 * random_m > 0)) {
    throw InputError("flight.climb_m: " + std::to_string(config.climb_m) + " from height_m " +
                     std::to_string(config.height_m) +
                     " reaches the ground; increase climb_m or height_m, or reduce sway_m");
  }
  if (is_turn && config.turn_rate_deg_s == 0) {
    throw InputError("flight.turn_rate_deg_s: 0 is invalid for shape turn; set a rate or use line");
  }
  if (config.rest_s > 0 && config.rest_s + kStart_s > config.duration_s) {
    throw InputError("flight.rest_s: " + std::to_string(config.rest_s) +
                     " s and 1 s of start exceed duration_s, " + std::to_string(config.duration_s) +
                     " s; reduce rest_s or increase duration_s");
  }
}

// Duration of the motion without the rest.
double moving_s(const FlightConfig& config) {
  return config.rest_s > 0 ? time_after_rest(config.duration_s, config.rest_s).value
                           : config.duration_s;
}

// Random motion of one axis: sway with periods of 4 to 40 s, and hand motion of 0.3 to 3 Hz.
std::vector<Signal::Sine> random_motion(double sway_rms, double hand_rms, std::uint64_t seed,
                                        std::uint64_t axis) {
  std::vector<Signal::Sine> sines = random_sines(sway_rms, 4, Random(seed, 1000 + axis));
  if (hand_rms == 0) return sines;
  const auto hand = random_sines(hand_rms, 1.0 / 3, Random(seed, 1010 + axis));
  sines.insert(sines.end(), hand.begin(), hand.end());
  return sines;
}

}  // namespace

Trajectory make_trajectory(const FlightConfig& config, std::uint64_t seed) {
  check_shape(config);
  const bool is_line = config.shape == FlightShape::line;
  const double heading = config.heading_deg * kDegree;
  const double x_m = config.forward_m * std::cos(heading) - config.left_m * std::sin(heading);
  const double y_m = config.forward_m * std::sin(heading) + config.left_m * std::cos(heading);
  const bool is_hand = config.shape == FlightShape::hand;
  const double hand_m = is_hand ? config.hand_m : 0.0;
  const double hand_rad = is_hand ? config.hand_deg * kDegree : 0.0;
  const auto translation = [&](std::uint64_t axis) {
    return random_motion(config.sway_m, hand_m, seed, axis);
  };
  const auto rotation = [&](double sway_deg, std::uint64_t axis) {
    return random_motion(sway_deg * kDegree, hand_rad, seed, axis);
  };
  const double T = moving_s(config);
  Trajectory trajectory{
      .x_m = exact_at_ends(0, is_line ? x_m : 0, T, translation(0)),
      .y_m = exact_at_ends(0, is_line ? y_m : 0, T, translation(1)),
      .z_m = exact_at_ends(config.height_m, is_line ? config.climb_m : 0, T, translation(2)),
      .yaw_rad = {heading, 0, rotation(config.yaw_sway_deg, 3)},
      .pitch_rad = {config.pitch_deg * kDegree, 0, rotation(config.tilt_sway_deg, 4)},
      .roll_rad = {config.roll_deg * kDegree, 0, rotation(config.tilt_sway_deg, 5)},
      .rest_s = config.rest_s};
  if (config.shape == FlightShape::turn) add_coordinated_turn(config, trajectory);
  if (config.shape == FlightShape::out_and_back) {
    add_out_and_back(x_m, T, trajectory.x_m);
    add_out_and_back(y_m, T, trajectory.y_m);
    add_out_and_back(config.climb_m, T, trajectory.z_m);
  }
  return trajectory;
}

}  // namespace stillkite
