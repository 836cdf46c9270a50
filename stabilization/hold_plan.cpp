#include "stabilization/hold_plan.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "geometry/time.hpp"
#include "stabilization/azimuth_to_displacement.hpp"
#include "stabilization/hold_errors.hpp"
#include "stabilization/tether.hpp"
#include "stabilization/tether_rates.hpp"

namespace stillkite {
namespace {

using Vector3d = Eigen::Vector3d;

constexpr std::size_t kYaw = 3;

HoldAxes position_at_rest(const HoldAxes& axes) {
  return {at_rest(axes[0]), at_rest(axes[1]), at_rest(axes[2]), axes[kYaw]};
}

// Nothing where the estimate does not say where home lies.
std::optional<Vector3d> direction_home(const HoldInput& input) {
  const Vector3d way = way_home_in_station(*input.estimate, input.station_from_camera);
  const double length = way.stableNorm();
  if (!(length > 1e-9)) return std::nullopt;
  return Vector3d(way / length);
}

// The mean shift is below its threshold while no angle is beyond its own: no action. Which of the
// angles is beyond does not matter to the paper, though only yaw can be commanded.
HoldReason paper_reason(const PaperHoldConfig& config, const MotionEstimate& estimate,
                        const EulerAngles& angles) {
  const double largest_rad =
      std::max({std::abs(angles.yaw_rad), std::abs(angles.pitch_rad), std::abs(angles.roll_rad)});
  if (largest_rad > config.max_angle_rad) return HoldReason::angle_first;
  if (estimate.mean_shift_px <= config.min_shift_px) return HoldReason::within_dead_band;
  if (estimate.displacement_kind == DisplacementKind::zero) return HoldReason::within_dead_band;
  if (estimate.displacement_kind == DisplacementKind::unknown) {
    return HoldReason::displacement_unknown;
  }
  return HoldReason::none;
}

// The way home in metres; nothing where it is not known.
std::optional<Vector3d> metric_way_home(const RecommendedHoldConfig& config,
                                        const HoldInput& input) {
  const MotionEstimate& estimate = *input.estimate;
  double length_m = 0;
  switch (estimate.displacement_kind) {
    case DisplacementKind::unknown:
      return std::nullopt;
    case DisplacementKind::zero:
      return Vector3d::Zero();
    case DisplacementKind::direction:
      length_m = config.nominal_depth_m * std::max(0.0, estimate.parallax_rad);
      break;
    case DisplacementKind::metric:
      length_m = estimate.displacement_in_reference.stableNorm();
      break;
  }
  const std::optional<Vector3d> direction = direction_home(input);
  if (!direction) {
    return estimate.displacement_kind == DisplacementKind::metric
               ? std::optional<Vector3d>(Vector3d::Zero())
               : std::nullopt;
  }
  return Vector3d(*direction * std::min(length_m, config.max_displacement_m));
}

// The rate at which way and turn home grow without commands, as the integrals have learned it.
LevelMotion learned_drift(const HoldAxes& axes) {
  return {axes[0].integral, axes[1].integral, axes[2].integral, axes[kYaw].integral};
}

// By how much way and turn home have changed by now: a drift is taken to have gone on since the
// exposure, and the drone has gone its own way.
LevelMotion since_exposure(const HoldInput& input, const LevelMotion& drift,
                           const VelocityModel& own) {
  const Timestamp exposure = input.estimate->stamp;
  return drift * seconds_between(exposure, input.now) - own.way_since(exposure);
}

// The same once the drone follows the commands it has: less what it will still coast.
LevelMotion predicted_change(const RecommendedHoldConfig& config, const HoldInput& input,
                             const HoldAxes& axes, const VelocityModel& own) {
  if (!config.predict) return LevelMotion::Zero();
  const LevelMotion drift = learned_drift(axes);
  return since_exposure(input, drift, own) + config.lag_s * (drift - own.rate());
}

// The way home by now, and the rate at which it grows without commands, by what moves the drone
// beside its own model: the station and the wind.
struct Home {
  Vector3d way_m;
  Vector3d drift_m_s;
  bool drift_is_measured;  // where the estimate knows the velocity
};

Home home_by_now(const RecommendedHoldConfig& config, const HoldInput& input, const HoldAxes& axes,
                 const VelocityModel& own, const Vector3d& way_m) {
  if (!config.predict) return {way_m, Vector3d::Zero(), false};
  LevelMotion drift = learned_drift(axes);
  const std::optional<Vector3d> velocity_m_s =
      velocity_in_station_m_s(*input.estimate, input.station_from_camera);
  if (velocity_m_s) {
    drift.head<3>() = own.rate_at(input.estimate->stamp).head<3>() - *velocity_m_s;
  }
  return {way_m + since_exposure(input, drift, own).head<3>(), drift.head<3>(),
          velocity_m_s.has_value()};
}

// By how much the command must lead the velocity for an acceleration of 1 over a step.
double lead_s(double lag_s, double dt_s) {
  if (!(dt_s > 0)) return lag_s;
  return lag_s > 0 ? -dt_s / std::expm1(-dt_s / lag_s) : dt_s;
}

// The velocity to command: d'' = -2 p d' - p^2 d follows from w' = (u - w) / lag.
Vector3d state_feedback(const RecommendedHoldConfig& config, const Home& home,
                        const VelocityModel& own, double dt_s) {
  const double pole = config.state_feedback_pole_1_s;
  const Vector3d own_now = own.rate().head<3>();
  const Vector3d velocity = own_now - home.drift_m_s;
  return own_now + lead_s(config.lag_s, dt_s) * (pole * pole * home.way_m - 2 * pole * velocity);
}

Vector3d low_passed(const Vector3d& mean, const Vector3d& value, double memory_s, double dt_s) {
  return memory_s > 0 ? Vector3d(mean - std::expm1(-dt_s / memory_s) * (value - mean)) : value;
}

// What the azimuth does near the zenith: the drone is to be kept where it is kept now and the way
// home on, and the station goes on without its gusts. Near is where that may ask for half of what
// the azimuth can.
OverheadTurn overhead_turn(const HoldConfig& config, const TetherState& here, const Vector3d& way_m,
                           const Vector3d& drift_m_s) {
  const RecommendedHoldConfig& recommended = config.recommended;
  const double limit_rad_s = config.limits.azimuth_rate_rad_s;
  const double within_m =
      std::max(recommended.damped_within_m, drift_m_s.head<2>().norm() / (limit_rad_s / 2));
  if (std::abs(tether_levers_m(here)[2]) > within_m) return {within_m, 0};
  const Vector3d kept_m = position_in_station(here) + way_m;
  return {within_m, azimuth_to_displacement_rad_s(
                        here.azimuth_rad, {kept_m.head<2>(), drift_m_s.head<2>()},
                        {limit_rad_s, recommended.lag_s}, recommended.overhead_horizon_s)};
}

// The axes after a step, their integrals grown but not towards what the vehicle cannot follow.
HoldAxes without_windup(const HoldAxes& before, const HoldAxes& after, const Vector3d& deficit) {
  HoldAxes axes = after;
  const double length = deficit.norm();
  if (!(length > 1e-9)) return axes;
  const Vector3d towards = deficit / length;
  Vector3d growth;
  for (int i = 0; i < 3; ++i) growth[i] = after[i].integral - before[i].integral;
  growth -= std::max(0.0, growth.dot(towards)) * towards;
  for (int i = 0; i < 3; ++i) axes[i].integral = before[i].integral + growth[i];
  return axes;
}

}  // namespace

PidState at_rest(const PidState& state) {
  return {.integral = state.integral};
}

HoldPlan plan_as_in_paper(const HoldConfig& config, const HoldInput& input,
                          const HoldMemory& before, double dt_s) {
  const PaperHoldConfig& paper = config.paper;
  const TetherState& here = input.tether->tether;
  const EulerAngles angles = paper_angles(*input.estimate);
  HoldPlan plan{.reason = paper_reason(paper, *input.estimate, angles),
                .turn_home_rad = -angles.pitch_rad,
                .memory = {.axes = position_at_rest(before.axes)}};
  if (plan.reason == HoldReason::within_dead_band) {
    plan.memory.axes[kYaw] = at_rest(before.axes[kYaw]);
    return plan;
  }
  const PidStep yaw = step(paper.yaw, before.axes[kYaw], plan.turn_home_rad, dt_s);
  plan.memory.axes[kYaw] = yaw.state;
  plan.command.yaw_rate_rad_s = yaw.output;

  const std::optional<Vector3d> direction = direction_home(input);
  if (plan.reason == HoldReason::none && !direction) {
    plan.reason = HoldReason::displacement_unknown;
  }
  if (plan.reason == HoldReason::none) {
    // the desired pose in the station's frame: the current one times the displacement
    plan.way_home_in_station_m = paper.unit_translation_m * *direction;
    const TetherState wanted =
        tether_to(position_in_station(here) + plan.way_home_in_station_m, here);
    const PidStep length =
        step(paper.length, before.axes[0], wanted.length_m - here.length_m, dt_s);
    const PidStep elevation =
        step(paper.elevation, before.axes[1], wanted.elevation_rad - here.elevation_rad, dt_s);
    const PidStep azimuth =
        step(paper.azimuth, before.axes[2], wanted.azimuth_rad - here.azimuth_rad, dt_s);
    plan.command.length_rate_m_s = length.output;
    plan.command.elevation_rate_rad_s = elevation.output;
    plan.command.azimuth_rate_rad_s = azimuth.output;
    plan.memory.axes = {length.state, elevation.state, azimuth.state, yaw.state};
  }
  plan.command = within_limits(config.limits, here, plan.command);
  return plan;
}

HoldPlan plan_recommended(const HoldConfig& config, const HoldInput& input,
                          const HoldMemory& before, const VelocityModel& own, double dt_s) {
  const RecommendedHoldConfig& recommended = config.recommended;
  const TetherState& here = input.tether->tether;
  HoldPlan plan{.turn_home_rad = turn_home_rad(*input.estimate, input.station_from_camera),
                .memory = {position_at_rest(before.axes), before.drift_in_station_m_s}};
  HoldAxes& axes = plan.memory.axes;
  const LevelMotion change = predicted_change(recommended, input, before.axes, own);
  const PidStep yaw =
      step(recommended.yaw, before.axes[kYaw], plan.turn_home_rad + change[kYaw], dt_s);
  axes[kYaw] = yaw.state;
  TetherCommand wanted;

  const std::optional<Vector3d> way = metric_way_home(recommended, input);
  if (std::abs(plan.turn_home_rad) > recommended.max_yaw_rad) {
    plan.reason = HoldReason::angle_first;
  } else if (!way) {
    plan.reason = HoldReason::displacement_unknown;
  } else {
    plan.way_home_in_station_m = *way;
    const Home home = home_by_now(recommended, input, before.axes, own, *way);
    Vector3d velocity_m_s;
    if (home.drift_is_measured && recommended.state_feedback_pole_1_s > 0) {
      velocity_m_s = state_feedback(recommended, home, own, dt_s);
    } else {
      for (int i = 0; i < 3; ++i) {
        const PidStep axis =
            step(recommended.position, before.axes[i], (*way)[i] + change[i], dt_s);
        axes[i] = axis.state;
        velocity_m_s[i] = axis.output;
      }
    }
    Vector3d& drift = plan.memory.drift_in_station_m_s;
    drift = low_passed(drift, home.drift_m_s, recommended.drift_memory_s, dt_s);
    wanted = rates_for_velocity(here, velocity_m_s, recommended.damped_within_m,
                                overhead_turn(config, here, home.way_m, drift));
    const TetherCommand possible = within_limits(config.limits, here, wanted);
    axes =
        without_windup(before.axes, axes, velocity_m_s - velocity_in_station_m_s(here, possible));
  }
  wanted.yaw_rate_rad_s = yaw.output;
  plan.command = within_limits(config.limits, here, wanted);
  return plan;
}

}  // namespace stillkite
