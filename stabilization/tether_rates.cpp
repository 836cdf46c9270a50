#include "stabilization/tether_rates.hpp"

#include <algorithm>
#include <cmath>

namespace stillkite {
namespace {

double damped_inverse(double lever_m, double damped_within_m) {
  const double x = lever_m / damped_within_m;
  const double d2 = damped_within_m * damped_within_m / 4 * std::max(0.0, 1 - x * x);
  return lever_m / (lever_m * lever_m + d2);
}

double azimuth_rate_rad_s(double lever_m, double tangential_m_s, const ZenithAzimuth& zenith) {
  const double x = lever_m / zenith.radius_m;
  const double weight = std::min(x * x, 1.0);
  const double inverse_1_m =
      weight < 1 ? lever_m / (zenith.radius_m * zenith.radius_m) : 1 / lever_m;
  return tangential_m_s * inverse_1_m + (1 - weight) * zenith.rate_rad_s;
}

double stopping_rate(double rate, double max_rate, double to_lower_end, double to_upper_end,
                     double time_s) {
  return std::clamp(rate, -std::clamp(to_lower_end / time_s, 0.0, max_rate),
                    std::clamp(to_upper_end / time_s, 0.0, max_rate));
}

}  // namespace

Eigen::Matrix3d tether_axes_in_station(const TetherState& tether) {
  const double ce = std::cos(tether.elevation_rad), se = std::sin(tether.elevation_rad);
  const double ca = std::cos(tether.azimuth_rad), sa = std::sin(tether.azimuth_rad);
  Eigen::Matrix3d axes;
  axes.col(0) << ce * ca, ce * sa, se;
  axes.col(1) << -se * ca, -se * sa, ce;
  axes.col(2) << -sa, ca, 0;
  return axes;
}

Eigen::Vector3d tether_levers_m(const TetherState& tether) {
  return {1, tether.length_m, tether.length_m * std::cos(tether.elevation_rad)};
}

Eigen::Vector3d velocity_in_station_m_s(const TetherState& tether, const TetherCommand& command) {
  const Eigen::Vector3d rates(command.length_rate_m_s, command.elevation_rate_rad_s,
                              command.azimuth_rate_rad_s);
  return tether_axes_in_station(tether) * tether_levers_m(tether).cwiseProduct(rates);
}

TetherCommand rates_for_velocity(const TetherState& tether,
                                 const Eigen::Vector3d& velocity_in_station_m_s,
                                 double damped_within_m, const ZenithAzimuth& zenith) {
  const Eigen::Vector3d along =
      tether_axes_in_station(tether).transpose() * velocity_in_station_m_s;
  const Eigen::Vector3d levers_m = tether_levers_m(tether);
  return {.length_rate_m_s = along[0],
          .elevation_rate_rad_s = along[1] * damped_inverse(levers_m[1], damped_within_m),
          .azimuth_rate_rad_s = azimuth_rate_rad_s(levers_m[2], along[2], zenith)};
}

TetherCommand within_limits(const VehicleLimits& limits, const TetherState& tether,
                            const TetherCommand& command) {
  const auto within = [](double rate, double max_rate) {
    return std::clamp(rate, -max_rate, max_rate);
  };
  const double time_s = limits.braking_time_s;
  return {.length_rate_m_s = stopping_rate(command.length_rate_m_s, limits.length_rate_m_s,
                                           tether.length_m - limits.min_length_m,
                                           limits.max_length_m - tether.length_m, time_s),
          .elevation_rate_rad_s =
              stopping_rate(command.elevation_rate_rad_s, limits.elevation_rate_rad_s,
                            tether.elevation_rad - limits.min_elevation_rad,
                            limits.max_elevation_rad() - tether.elevation_rad, time_s),
          .azimuth_rate_rad_s = within(command.azimuth_rate_rad_s, limits.azimuth_rate_rad_s),
          .yaw_rate_rad_s = within(command.yaw_rate_rad_s, limits.yaw_rate_rad_s)};
}

}  // namespace stillkite
