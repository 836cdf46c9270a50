#include "stabilization/tether.hpp"

#include <cmath>
#include <numbers>

namespace stillkite {
namespace {

// Minimum ratio of horizontal distance to length at which the azimuth is above rounding error.
constexpr double kMinHorizontalRatio = 1e-9;

double nearest_equivalent_rad(double angle_rad, double near_rad) {
  return near_rad + std::remainder(angle_rad - near_rad, 2 * std::numbers::pi);
}

double squared_difference_rad2(const TetherState& a, const TetherState& b) {
  return std::pow(a.elevation_rad - b.elevation_rad, 2) +
         std::pow(a.azimuth_rad - b.azimuth_rad, 2);
}

}  // namespace

Eigen::Vector3d position_in_station(const TetherState& tether) {
  const double horizontal_m = tether.length_m * std::cos(tether.elevation_rad);
  return {horizontal_m * std::cos(tether.azimuth_rad), horizontal_m * std::sin(tether.azimuth_rad),
          tether.length_m * std::sin(tether.elevation_rad)};
}

TetherState tether_to(const Eigen::Vector3d& position_in_station_m, const TetherState& near) {
  const Eigen::Vector3d& p = position_in_station_m;
  const double length_m = std::hypot(p.x(), p.y(), p.z());
  if (length_m == 0) return {0, near.elevation_rad, near.azimuth_rad};
  const double horizontal_m = std::hypot(p.x(), p.y());
  const double elevation_rad = std::atan2(p.z(), horizontal_m);
  if (horizontal_m <= kMinHorizontalRatio * length_m)
    return {length_m, elevation_rad, near.azimuth_rad};
  // two solutions: elevation up to pi/2, or beyond it with the opposite azimuth
  const double azimuth_rad = std::atan2(p.y(), p.x());
  const TetherState ahead{length_m, elevation_rad,
                          nearest_equivalent_rad(azimuth_rad, near.azimuth_rad)};
  const TetherState behind{
      length_m, std::numbers::pi - elevation_rad,
      nearest_equivalent_rad(azimuth_rad + std::numbers::pi, near.azimuth_rad)};
  return squared_difference_rad2(behind, near) < squared_difference_rad2(ahead, near) ? behind
                                                                                      : ahead;
}

}  // namespace stillkite
