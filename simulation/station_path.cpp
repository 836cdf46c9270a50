#include "simulation/station_path.hpp"

#include <algorithm>
#include <cmath>

namespace stillkite {
namespace {

// A move along a line from rest to rest: up to speed, steady, down to rest.
struct Leg {
  double way_m = 0;  // signed
  double ramp_s = 0;
  double steady_s = 0;
  double acceleration_m_s2 = 0;

  [[nodiscard]] double duration_s() const { return 2 * ramp_s + steady_s; }
};

struct PlaceOnLine {
  double position_m = 0;
  double velocity_m_s = 0;
};

Leg leg_over(const StationPathConfig& config, double way_m) {
  const double acceleration = config.acceleration_m_s2;
  // a way too short to reach the speed is all ramps
  const double peak_m_s = std::min(config.speed_m_s, std::sqrt(std::abs(way_m) * acceleration));
  return {way_m, peak_m_s / acceleration, std::abs(way_m) / peak_m_s - peak_m_s / acceleration,
          acceleration};
}

PlaceOnLine place_on(const Leg& leg, double t_s) {
  const double sign = leg.way_m < 0 ? -1 : 1;
  const double peak_m_s = leg.acceleration_m_s2 * leg.ramp_s;
  const double left_s = leg.duration_s() - t_s;
  if (t_s < leg.ramp_s) {
    return {sign * 0.5 * leg.acceleration_m_s2 * t_s * t_s, sign * leg.acceleration_m_s2 * t_s};
  }
  if (left_s < leg.ramp_s) {
    return {leg.way_m - sign * 0.5 * leg.acceleration_m_s2 * left_s * left_s,
            sign * leg.acceleration_m_s2 * left_s};
  }
  return {sign * peak_m_s * (t_s - 0.5 * leg.ramp_s), sign * peak_m_s};
}

std::array<Leg, 3> legs_of(const StationPathConfig& config) {
  const double reach_m =
      config.axis == PaperAxis::y ? config.upright_reach_m : config.level_reach_m;
  return {leg_over(config, reach_m), leg_over(config, -2 * reach_m), leg_over(config, reach_m)};
}

PlaceOnLine place_at(const StationPathConfig& config, double t_s) {
  double start_m = 0;
  double since_s = std::max(0.0, t_s);
  for (const Leg& leg : legs_of(config)) {
    if (since_s < leg.duration_s()) {
      const PlaceOnLine place = place_on(leg, since_s);
      return {start_m + place.position_m, place.velocity_m_s};
    }
    since_s -= leg.duration_s();
    start_m += leg.way_m;
  }
  return {};
}

}  // namespace

Eigen::Vector3d paper_axis_in_world(PaperAxis axis) {
  switch (axis) {
    case PaperAxis::x:
      return Eigen::Vector3d::UnitX();
    case PaperAxis::y:
      return Eigen::Vector3d::UnitZ();
    case PaperAxis::z:
      break;
  }
  return -Eigen::Vector3d::UnitY();
}

StationState station_at(const StationPathConfig& config, double t_s) {
  const PlaceOnLine place = place_at(config, t_s);
  const Eigen::Vector3d axis = paper_axis_in_world(config.axis);
  const double heading_rad = config.axis == PaperAxis::z ? std::atan2(axis.y(), axis.x()) : 0.0;
  const Eigen::Vector3d start(0, 0, config.height_m);
  return {{Eigen::Quaterniond(Eigen::AngleAxisd(heading_rad, Eigen::Vector3d::UnitZ())),
           start + place.position_m * axis},
          place.velocity_m_s * axis};
}

double station_duration_s(const StationPathConfig& config) {
  double sum_s = 0;
  for (const Leg& leg : legs_of(config)) sum_s += leg.duration_s();
  return sum_s;
}

}  // namespace stillkite
