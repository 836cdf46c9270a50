#include "simulation/hover/station_path.hpp"

#include <algorithm>
#include <cmath>

namespace stillkite {

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

StationPath::StationPath(const StationPathConfig& config, PaperAxis moved)
    : config_(config), moved_(moved) {
  const double reach_m = moved == PaperAxis::y ? config.vertical_reach_m : config.level_reach_m;
  legs_ = {leg_over(reach_m), leg_over(-2 * reach_m), leg_over(reach_m)};
}

StationState StationPath::at(double t_s) const {
  const LineState state = state_on_line(t_s);
  const Eigen::Vector3d axis = paper_axis_in_world(moved_);
  const double heading_rad = moved_ == PaperAxis::z ? std::atan2(axis.y(), axis.x()) : 0.0;
  const Eigen::Vector3d start(0, 0, config_.height_m);
  return {{Eigen::Quaterniond(Eigen::AngleAxisd(heading_rad, Eigen::Vector3d::UnitZ())),
           start + state.position_m * axis},
          state.velocity_m_s * axis};
}

double StationPath::duration_s() const {
  double sum_s = 0;
  for (const Leg& leg : legs_) sum_s += leg.duration_s();
  return sum_s;
}

// Triangular speed profile if the displacement is too short for the cruise speed.
StationPath::Leg StationPath::leg_over(double displacement_m) const {
  const double acceleration = config_.acceleration_m_s2;
  const double peak_m_s =
      std::min(config_.speed_m_s, std::sqrt(std::abs(displacement_m) * acceleration));
  return {.displacement_m = displacement_m,
          .ramp_s = peak_m_s / acceleration,
          .steady_s = std::abs(displacement_m) / peak_m_s - peak_m_s / acceleration};
}

StationPath::LineState StationPath::state_on_leg(const Leg& leg, double t_s) const {
  const double sign = leg.displacement_m < 0 ? -1 : 1;
  const double acceleration = sign * config_.acceleration_m_s2;
  const double remaining_s = leg.duration_s() - t_s;
  if (t_s < leg.ramp_s) return {0.5 * acceleration * t_s * t_s, acceleration * t_s};
  if (remaining_s < leg.ramp_s) {
    return {leg.displacement_m - 0.5 * acceleration * remaining_s * remaining_s,
            acceleration * remaining_s};
  }
  const double peak_m_s = acceleration * leg.ramp_s;
  return {peak_m_s * (t_s - 0.5 * leg.ramp_s), peak_m_s};
}

StationPath::LineState StationPath::state_on_line(double t_s) const {
  double start_m = 0;
  double since_s = std::max(0.0, t_s);
  for (const Leg& leg : legs_) {
    if (since_s < leg.duration_s()) {
      const LineState state = state_on_leg(leg, since_s);
      return {start_m + state.position_m, state.velocity_m_s};
    }
    since_s -= leg.duration_s();
    start_m += leg.displacement_m;
  }
  return {};
}

}  // namespace stillkite
