#include "simulation/hover/wind.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/angle.hpp"

namespace stillkite {
namespace {

// Integrals of s^k exp(-z s) over s from 0 to 1, k = 0, 1, 2.
std::array<double, 3> exponential_moments(double z) {
  std::array<double, 3> moments{};
  if (z > 1) {
    double previous = 0;
    for (int k = 0; k < 3; ++k) {
      moments[k] = ((k == 0 ? 1.0 : k * previous) - std::exp(-z)) / z;
      previous = moments[k];
    }
    return moments;
  }
  // power series: the recursion above suffers from cancellation
  double term = 1;
  for (int n = 0; n < 20; ++n) {
    for (int k = 0; k < 3; ++k) moments[k] += term / (n + k + 1);
    term *= -z / (n + 1);
  }
  return moments;
}

// Exact step of x1' = -x1 / T + x2, x2' = -x2 / T + n under white noise n of density 1: transition
// exp(-h / T) [1 h; 0 1], added covariance the integral of exp(-2 s / T) [s; 1] [s 1] from 0 to h.
Eigen::Vector2d filter_step(const Eigen::Vector2d& state, double T, double h, Random& random) {
  const auto [second, mixed, first] = exponential_moments(2 * h / T);
  const double root = std::sqrt(second);
  const double rest = std::sqrt(std::max(0.0, first - mixed * mixed / second));
  const double n1 = random.normal();
  const double n2 = random.normal();
  const double decay = std::exp(-h / T);
  return {decay * (state.x() + h * state.y()) + h * std::sqrt(h) * (mixed / root * n1 + rest * n2),
          decay * state.y() + std::sqrt(h) * root * n1};
}

// Sample of the stationary distribution, covariance [T^3/4 T^2/4; T^2/4 T/2].
Eigen::Vector2d stationary_sample(double T, Random& random) {
  const double n1 = random.normal();
  const double n2 = random.normal();
  const double root = std::sqrt(T / 2);
  return {root * T / 2 * (n1 + n2), root * n1};
}

// Filter output (1 + sqrt(3) T s) / (1 + T s)^2, scaled to standard deviation 1.
double output(const Eigen::Vector2d& state, double T) {
  const double a = 1 / T;
  return std::sqrt(3 * a) * (state.y() + (a / std::sqrt(3.0) - a) * state.x());
}

}  // namespace

GustScales dryden_scales(const WindConfig& config) {
  constexpr double kFoot_m = 0.3048;
  const double h = config.height_m / kFoot_m;
  const double base = 0.177 + 0.000823 * h;
  const double level_length_m = kFoot_m * h / std::pow(base, 1.2);
  const double upward_m_s = 0.1 * config.mean_m_s;
  const double level_m_s = upward_m_s / std::pow(base, 0.4);
  return {
      .deviation_m_s = {level_m_s, level_m_s, upward_m_s},
      .time_s = Eigen::Vector3d(level_length_m, level_length_m, config.height_m) / config.mean_m_s};
}

DrydenWind::DrydenWind(const WindConfig& config, std::uint64_t seed)
    : world_from_wind_(Eigen::AngleAxisd(config.towards_deg * kDegree, Eigen::Vector3d::UnitZ())
                           .toRotationMatrix()),
      gusts_(config.gusts && config.mean_m_s > 0),
      scales_(dryden_scales(config)),
      random_(seed),
      across_(Eigen::Vector2d::Zero()),
      upwards_(Eigen::Vector2d::Zero()) {
  mean_in_world_m_s_ = config.mean_m_s * world_from_wind_.col(0);
  if (!gusts_) return;
  along_m_s_ = scales_.deviation_m_s.x() * random_.normal();
  across_ = stationary_sample(scales_.time_s.y(), random_);
  upwards_ = stationary_sample(scales_.time_s.z(), random_);
}

Eigen::Vector3d DrydenWind::in_world_m_s() const {
  if (!gusts_) return mean_in_world_m_s_;
  const Eigen::Vector3d gust(along_m_s_,
                             scales_.deviation_m_s.y() * output(across_, scales_.time_s.y()),
                             scales_.deviation_m_s.z() * output(upwards_, scales_.time_s.z()));
  return mean_in_world_m_s_ + world_from_wind_ * gust;
}

void DrydenWind::step(double duration_s) {
  if (!gusts_) return;
  const double decay = std::exp(-duration_s / scales_.time_s.x());
  along_m_s_ = decay * along_m_s_ +
               scales_.deviation_m_s.x() * std::sqrt(1 - decay * decay) * random_.normal();
  across_ = filter_step(across_, scales_.time_s.y(), duration_s, random_);
  upwards_ = filter_step(upwards_, scales_.time_s.z(), duration_s, random_);
}

}  // namespace stillkite
