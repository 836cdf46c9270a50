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
// Cost of the rate limit, as a distance of the target from the plane.
constexpr double kRateLimitCost_m = 0.005;

// Direction of rotation until the plane contains the target for the first time.
enum class Direction { left, shortest, right };

struct PolarTarget {
  double distance_m;  // horizontal, from the zenith
  double azimuth_rad;
};

using Prediction = std::array<PolarTarget, kSteps>;

Prediction predict(const HorizontalTarget& target, double step_s) {
  Prediction prediction{};
  double time_s = 0;
  for (PolarTarget& at : prediction) {
    time_s += step_s;
    const Eigen::Vector2d position_m = target.position_m + time_s * target.velocity_m_s;
    at = {position_m.norm(), std::atan2(position_m.y(), position_m.x())};
  }
  return prediction;
}

// Angle per unit of commanded rate after a step from rest: t + lag (exp(-t / lag) - 1).
double step_response_s(double time_s, double lag_s) {
  return lag_s > 0 ? time_s + lag_s * std::expm1(-time_s / lag_s) : time_s;
}

double squared_distance_m2(const PolarTarget& target, double azimuth_rad) {
  const double distance_m = target.distance_m * std::sin(azimuth_rad - target.azimuth_rad);
  return distance_m * distance_m;
}

// Mean squared distance of the target from the plane, which follows it by at most
// `max_rotation_rad` a step after the first step.
double mean_squared_distance_m2(const Prediction& prediction, double azimuth_rad,
                                double max_rotation_rad, Direction direction) {
  double sum_m2 = squared_distance_m2(prediction.front(), azimuth_rad);
  for (std::size_t k = 1; k < prediction.size(); ++k) {
    double rotation_rad = std::remainder(prediction[k].azimuth_rad - azimuth_rad, kPi);
    if (std::abs(rotation_rad) < max_rotation_rad) direction = Direction::shortest;
    if (direction == Direction::left && rotation_rad < 0) rotation_rad += kPi;
    if (direction == Direction::right && rotation_rad > 0) rotation_rad -= kPi;
    azimuth_rad += std::clamp(rotation_rad, -max_rotation_rad, max_rotation_rad);
    sum_m2 += squared_distance_m2(prediction[k], azimuth_rad);
  }
  return sum_m2 / kSteps;
}

// Minimum of the parabola through the values at -1, 0 and 1; the middle value is the smallest.
double parabola_minimum(double left, double middle, double right) {
  const double curvature = left - 2 * middle + right;
  return curvature > 0 ? 0.5 * (left - right) / curvature : 0;
}

}  // namespace

double azimuth_to_displacement_rad_s(double azimuth_rad, const HorizontalTarget& target,
                                     const AzimuthDynamics& dynamics, double horizon_s) {
  const double step_s = horizon_s / kSteps;
  const Prediction prediction = predict(target, step_s);
  const double first_s = step_response_s(step_s, dynamics.lag_s);
  const double rate_step_rad_s = dynamics.rate_limit_rad_s / kRates;
  std::array<double, 2 * kRates + 1> costs_m2{};  // per first rate, with the best continuation
  for (std::size_t i = 0; i < costs_m2.size(); ++i) {
    const int rate = static_cast<int>(i) - kRates;
    const double first_azimuth_rad = azimuth_rad + rate_step_rad_s * rate * first_s;
    double distance_m2 = std::numeric_limits<double>::infinity();
    for (const Direction direction : {Direction::left, Direction::shortest, Direction::right}) {
      distance_m2 = std::min(
          distance_m2, mean_squared_distance_m2(prediction, first_azimuth_rad,
                                                dynamics.rate_limit_rad_s * step_s, direction));
    }
    const double rate_cost_m = kRateLimitCost_m * rate / kRates;
    costs_m2[i] = distance_m2 + rate_cost_m * rate_cost_m;
  }
  const auto best = static_cast<std::size_t>(std::min_element(costs_m2.begin(), costs_m2.end()) -
                                             costs_m2.begin());
  if (!std::isfinite(costs_m2[best])) return 0;
  const double rate_rad_s = rate_step_rad_s * (static_cast<int>(best) - kRates);
  if (best == 0 || best + 1 == costs_m2.size()) return rate_rad_s;
  return rate_rad_s +
         rate_step_rad_s * parabola_minimum(costs_m2[best - 1], costs_m2[best], costs_m2[best + 1]);
}

}  // namespace stillkite
