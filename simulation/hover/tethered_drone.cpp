#include "simulation/hover/tethered_drone.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/euler.hpp"

namespace stillkite {
namespace {

double limited_rate(double rate, double limit) {
  return std::isfinite(rate) ? std::clamp(rate, -limit, limit) : 0.0;
}

TetherCommand limit(const TetherCommand& command, const TetheredDroneConfig& config) {
  return {limited_rate(command.length_rate_m_s, config.length_rate_limit_m_s),
          limited_rate(command.elevation_rate_rad_s, config.elevation_rate_limit_rad_s),
          limited_rate(command.azimuth_rate_rad_s, config.azimuth_rate_limit_rad_s),
          limited_rate(command.yaw_rate_rad_s, config.yaw_rate_limit_rad_s)};
}

}  // namespace

TetheredDrone::TetheredDrone(const TetheredDroneConfig& config,
                             const RigidTransform& body_from_camera, const StationState& station,
                             double yaw_rad)
    : config_(config),
      body_from_camera_(body_from_camera),
      world_from_station_(station.world_from_station),
      length_{.value = config.start_length_m},
      elevation_{.value = std::numbers::pi / 2},
      yaw_{.value = yaw_rad} {
  if (!(config.shortest_m <= config.start_length_m && config.start_length_m <= config.longest_m)) {
    throw InputError("drone.start_length_m: must be between shortest_m and longest_m");
  }
  update_pose(0);
}

void TetheredDrone::step(const TetherCommand& command, const Disturbance& disturbance,
                         const StationState& station, double duration_s) {
  if (!(duration_s > 0)) return;
  constexpr double kMaxStep_s = 0.005;
  const int steps = std::max(1, static_cast<int>(std::ceil(duration_s / kMaxStep_s - 1e-6)));
  const double step_s = duration_s / steps;
  const RigidTransform before = world_from_station_;
  const TetherCommand limited = limit(command, config_);
  for (int k = 1; k <= steps; ++k) {
    const DroneTruth last = truth_;
    const double last_yaw_rad = yaw_.value;
    world_from_station_ = k == steps
                              ? station.world_from_station
                              : interpolate(before, station.world_from_station, double(k) / steps);
    advance(limited, disturbance.wind_in_world_m_s, step_s);
    yaw_.value += disturbance.yaw_kick_rad / steps;
    update_pose(disturbance.loose_tether_m);
    update_velocity(
        (truth_.world_from_body.translation - last.world_from_body.translation) / step_s, step_s);
    truth_.yaw_rate_rad_s = (yaw_.value - last_yaw_rad) / step_s;
  }
}

// A mean velocity is valid at the middle of its step: linear extrapolation to the end of the step.
void TetheredDrone::update_velocity(const Eigen::Vector3d& mean_m_s, double step_s) {
  const MeanVelocity last = mean_velocity_.value_or(MeanVelocity{mean_m_s, step_s});
  truth_.velocity_in_world_m_s =
      mean_m_s + step_s / (step_s + last.step_s) * (mean_m_s - last.in_world_m_s);
  mean_velocity_ = {mean_m_s, step_s};
}

// r' = (command - r) / lag and x' = r over a duration with a constant command.
TetheredDrone::Axis TetheredDrone::follow(const Axis& axis, double command, double lag_s,
                                          double duration_s) {
  const double decay = std::exp(-duration_s / lag_s);
  const double excess = axis.rate - command;
  return {axis.value + command * duration_s + excess * lag_s * (1 - decay),
          command + excess * decay};
}

TetheredDrone::Axis TetheredDrone::clamped(const Axis& axis, double low, double high) {
  if (axis.value >= low && axis.value <= high) return axis;
  return {.value = std::clamp(axis.value, low, high), .rate = 0};
}

void TetheredDrone::advance(const TetherCommand& limited, const Eigen::Vector3d& wind,
                            double duration_s) {
  const double lag_s = config_.lag_s;
  length_ = clamped(follow(length_, limited.length_rate_m_s, lag_s, duration_s), config_.shortest_m,
                    config_.longest_m);
  elevation_ = clamped(follow(elevation_, limited.elevation_rate_rad_s, lag_s, duration_s), 0,
                       std::numbers::pi);
  azimuth_ = follow(azimuth_, limited.azimuth_rate_rad_s, lag_s, duration_s);
  yaw_ = follow(yaw_, limited.yaw_rate_rad_s, lag_s, duration_s);
  lagged_wind_in_world_m_s_ =
      wind + (lagged_wind_in_world_m_s_ - wind) * std::exp(-duration_s / config_.wind_lag_s);
}

void TetheredDrone::update_pose(double loose_tether_m) {
  const TetherState held{length_.value, elevation_.value, azimuth_.value};
  const Eigen::Vector3d held_position = world_from_station_.rotation * position_in_station(held);
  const Eigen::Vector3d along = held_position / held.length_m;
  const double towards_station_m_s = -lagged_wind_in_world_m_s_.dot(along);
  const Eigen::Vector3d across_m_s = lagged_wind_in_world_m_s_ + towards_station_m_s * along;
  const double by_wind_m =
      config_.shift_per_wind_s * std::max(0.0, towards_station_m_s - config_.taut_up_to_wind_m_s);
  const double slack_m = std::min(by_wind_m + loose_tether_m, held.length_m);

  const Eigen::Vector3d direction =
      (held_position + config_.shift_per_wind_s * across_m_s).normalized();
  const Eigen::Vector3d from_station = (held.length_m - slack_m) * direction;
  truth_.world_from_body = {to_quaternion({.yaw_rad = yaw_.value}),
                            world_from_station_.translation + from_station};
  truth_.world_from_camera = truth_.world_from_body * body_from_camera_;
  truth_.tether =
      tether_to(held.length_m * (world_from_station_.rotation.conjugate() * direction), held);
  truth_.tether.length_m = held.length_m;
  truth_.tether_status = loose_tether_m > 0 ? TetherStatus::slack_by_fault
                         : by_wind_m > 0    ? TetherStatus::slack_by_wind
                                            : TetherStatus::taut;
}

}  // namespace stillkite
