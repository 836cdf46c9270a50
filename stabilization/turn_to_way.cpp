#include "stabilization/turn_to_way.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace stillkite {
namespace {

constexpr double kFirstMove_s = 0.5;
constexpr int kInstants = 12;
constexpr int kRates = 10;  // to either side of 0
// What turning as fast as it can costs: as much as a plane that is off the way by this.
constexpr double kWorthTheTurn_m = 0.005;

struct Instant {
  double distance_m;             // of the way from overhead
  double azimuth_rad;            // of the way
  double first_s, afterwards_s;  // for how long the azimuth has followed either move
};

// Under a rate that is followed with a first-order lag.
double followed_s(double time_s, double lag_s) {
  if (!(time_s > 0)) return 0;
  return lag_s > 0 ? time_s + lag_s * std::expm1(-time_s / lag_s) : time_s;
}

std::array<Instant, kInstants> look_ahead(const LevelWay& way, double lag_s, double horizon_s) {
  std::array<Instant, kInstants> instants{};
  for (int k = 0; k < kInstants; ++k) {
    const double time_s = horizon_s * (k + 1) / kInstants;
    const Eigen::Vector2d place_m = way.now_m + time_s * way.drift_m_s;
    const double afterwards_s = followed_s(time_s - kFirstMove_s, lag_s);
    instants[static_cast<std::size_t>(k)] = {.distance_m = place_m.norm(),
                                             .azimuth_rad = std::atan2(place_m.y(), place_m.x()),
                                             .first_s = followed_s(time_s, lag_s) - afterwards_s,
                                             .afterwards_s = afterwards_s};
  }
  return instants;
}

// Mean square of how far the way is off the plane under these two rates.
double off_the_plane_m2(const std::array<Instant, kInstants>& instants, double azimuth_rad,
                        double first_rad_s, double afterwards_rad_s) {
  double sum_m2 = 0;
  for (const Instant& at : instants) {
    const double turned_rad = first_rad_s * at.first_s + afterwards_rad_s * at.afterwards_s;
    const double off_m = at.distance_m * std::sin(azimuth_rad + turned_rad - at.azimuth_rad);
    sum_m2 += off_m * off_m;
  }
  return sum_m2 / kInstants;
}

// Of three values in a row the middle one is the least: where between them a parabola is.
double lowest_between(double left, double middle, double right) {
  const double bend = left - 2 * middle + right;
  return bend > 0 ? 0.5 * (left - right) / bend : 0;
}

}  // namespace

double turn_to_way_rad_s(double azimuth_rad, const LevelWay& way, const AzimuthDrive& drive,
                         double horizon_s) {
  const std::array<Instant, kInstants> instants = look_ahead(way, drive.lag_s, horizon_s);
  const double step_rad_s = drive.rate_limit_rad_s / kRates;
  std::array<double, 2 * kRates + 1> costs_m2{};  // of a first rate, with the best that may follow
  for (std::size_t i = 0; i < costs_m2.size(); ++i) {
    const int first = static_cast<int>(i) - kRates;
    double off_m2 = std::numeric_limits<double>::infinity();
    for (int then = -kRates; then <= kRates; ++then) {
      off_m2 = std::min(
          off_m2, off_the_plane_m2(instants, azimuth_rad, step_rad_s * first, step_rad_s * then));
    }
    const double turned_m = kWorthTheTurn_m * first / kRates;
    costs_m2[i] = off_m2 + turned_m * turned_m;
  }
  const auto best = static_cast<std::size_t>(std::min_element(costs_m2.begin(), costs_m2.end()) -
                                             costs_m2.begin());
  if (!std::isfinite(costs_m2[best])) return 0;  // no way that can be
  const double rate_rad_s = step_rad_s * (static_cast<int>(best) - kRates);
  if (best == 0 || best + 1 == costs_m2.size()) return rate_rad_s;
  return rate_rad_s +
         step_rad_s * lowest_between(costs_m2[best - 1], costs_m2[best], costs_m2[best + 1]);
}

}  // namespace stillkite
