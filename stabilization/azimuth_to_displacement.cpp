#include "stabilization/azimuth_to_displacement.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace stillkite {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kSteps = 16;
constexpr int kRates = 10;  // to either side of 0
// What turning as fast as it can costs: as much as a plane that is off the way by this.
constexpr double kWorthTheTurn_m = 0.005;

// Which way round the plane turns until it holds the way for the first time.
enum class Round { left, nearer, right };

struct Instant {
  double distance_m;   // of the way from overhead
  double azimuth_rad;  // of the way
};

using Ahead = std::array<Instant, kSteps>;

Ahead look_ahead(const LevelWay& way, double step_s) {
  Ahead ahead{};
  double time_s = 0;
  for (Instant& at : ahead) {
    time_s += step_s;
    const Eigen::Vector2d place_m = way.now_m + time_s * way.drift_m_s;
    at = {place_m.norm(), std::atan2(place_m.y(), place_m.x())};
  }
  return ahead;
}

// Under a rate that is followed with a first-order lag, from rest.
double followed_s(double time_s, double lag_s) {
  return lag_s > 0 ? time_s + lag_s * std::expm1(-time_s / lag_s) : time_s;
}

double squared_m2(const Instant& at, double azimuth_rad) {
  const double off_m = at.distance_m * std::sin(azimuth_rad - at.azimuth_rad);
  return off_m * off_m;
}

// Mean square of how far the way is off the plane, which after the first step turns after it by at
// most `most_rad` a step.
double off_the_plane_m2(const Ahead& ahead, double azimuth_rad, double most_rad, Round round) {
  double sum_m2 = squared_m2(ahead.front(), azimuth_rad);
  for (std::size_t k = 1; k < ahead.size(); ++k) {
    double turn_rad = std::remainder(ahead[k].azimuth_rad - azimuth_rad, kPi);
    if (std::abs(turn_rad) < most_rad) round = Round::nearer;
    if (round == Round::left && turn_rad < 0) turn_rad += kPi;
    if (round == Round::right && turn_rad > 0) turn_rad -= kPi;
    azimuth_rad += std::clamp(turn_rad, -most_rad, most_rad);
    sum_m2 += squared_m2(ahead[k], azimuth_rad);
  }
  return sum_m2 / kSteps;
}

// Of three values in a row the middle one is the least: where between them a parabola is.
double lowest_between(double left, double middle, double right) {
  const double bend = left - 2 * middle + right;
  return bend > 0 ? 0.5 * (left - right) / bend : 0;
}

}  // namespace

double azimuth_to_displacement_rad_s(double azimuth_rad, const LevelWay& way,
                                     const AzimuthDrive& drive, double horizon_s) {
  const double step_s = horizon_s / kSteps;
  const Ahead ahead = look_ahead(way, step_s);
  const double first_s = followed_s(step_s, drive.lag_s);
  const double rate_step_rad_s = drive.rate_limit_rad_s / kRates;
  std::array<double, 2 * kRates + 1> costs_m2{};  // of a first rate, with the best that may follow
  for (std::size_t i = 0; i < costs_m2.size(); ++i) {
    const int rate = static_cast<int>(i) - kRates;
    const double turned_rad = azimuth_rad + rate_step_rad_s * rate * first_s;
    double off_m2 = std::numeric_limits<double>::infinity();
    for (const Round round : {Round::left, Round::nearer, Round::right}) {
      off_m2 = std::min(
          off_m2, off_the_plane_m2(ahead, turned_rad, drive.rate_limit_rad_s * step_s, round));
    }
    const double turned_m = kWorthTheTurn_m * rate / kRates;
    costs_m2[i] = off_m2 + turned_m * turned_m;
  }
  const auto best = static_cast<std::size_t>(std::min_element(costs_m2.begin(), costs_m2.end()) -
                                             costs_m2.begin());
  if (!std::isfinite(costs_m2[best])) return 0;  // no way that can be
  const double rate_rad_s = rate_step_rad_s * (static_cast<int>(best) - kRates);
  if (best == 0 || best + 1 == costs_m2.size()) return rate_rad_s;
  return rate_rad_s +
         rate_step_rad_s * lowest_between(costs_m2[best - 1], costs_m2[best], costs_m2[best + 1]);
}

}  // namespace stillkite
