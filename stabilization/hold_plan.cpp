#include "stabilization/hold_plan.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "geometry/time.hpp"
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

// What way and turn home will be once the drone follows the commands it has: less what it has gone
// since the exposure and will still coast, both beyond the station's own motion, which the
// integrals have learned.
LevelMotion predicted_change(const RecommendedHoldConfig& config, const HoldInput& input,
                             const HoldAxes& axes, const OwnMotion& own) {
  if (!config.predict) return LevelMotion::Zero();
  const LevelMotion drift(axes[0].integral, axes[1].integral, axes[2].integral,
                          axes[kYaw].integral);
  const double age_s = seconds_between(input.estimate->stamp, input.now);
  return drift * age_s - own.way_since(input.estimate->stamp) + config.lag_s * (drift - own.rate());
}

// The velocity to command where way and velocity are both known in metres. The station (and the
// wind) moved the drone by what it does beside its own model, and is taken to go on; then way and
// velocity by now are known, and d'' = -2 p d' - p^2 d follows from w' = (u - w) / lag.
std::optional<Vector3d> state_feedback(const RecommendedHoldConfig& config, const HoldInput& input,
                                       const OwnMotion& own, const Vector3d& way_home_m) {
  const double pole = config.state_feedback_pole_1_s;
  const std::optional<Vector3d> velocity_m_s =
      velocity_in_station_m_s(*input.estimate, input.station_from_camera);
  if (!velocity_m_s || !config.predict || !(pole > 0)) return std::nullopt;
  const Timestamp exposure = input.estimate->stamp;
  const double age_s = seconds_between(exposure, input.now);
  const Vector3d own_now = own.rate().head<3>();
  const Vector3d carried = *velocity_m_s - own.rate_at(exposure).head<3>();
  const Vector3d way = way_home_m - carried * age_s - own.way_since(exposure).head<3>();
  const Vector3d velocity = carried + own_now;
  return Vector3d(own_now + config.lag_s * (pole * pole * way - 2 * pole * velocity));
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

HoldPlan plan_as_in_paper(const HoldConfig& config, const HoldInput& input, const HoldAxes& axes,
                          double dt_s) {
  const PaperHoldConfig& paper = config.paper;
  const TetherState& here = input.tether->tether;
  const EulerAngles angles = paper_angles(*input.estimate);
  HoldPlan plan{.reason = paper_reason(paper, *input.estimate, angles),
                .turn_home_rad = -angles.pitch_rad,
                .axes = position_at_rest(axes)};
  if (plan.reason == HoldReason::within_dead_band) {
    plan.axes[kYaw] = at_rest(axes[kYaw]);
    return plan;
  }
  const PidStep yaw = step(paper.yaw, axes[kYaw], plan.turn_home_rad, dt_s);
  plan.axes[kYaw] = yaw.state;
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
    const PidStep length = step(paper.length, axes[0], wanted.length_m - here.length_m, dt_s);
    const PidStep elevation =
        step(paper.elevation, axes[1], wanted.elevation_rad - here.elevation_rad, dt_s);
    const PidStep azimuth =
        step(paper.azimuth, axes[2], wanted.azimuth_rad - here.azimuth_rad, dt_s);
    plan.command.length_rate_m_s = length.output;
    plan.command.elevation_rate_rad_s = elevation.output;
    plan.command.azimuth_rate_rad_s = azimuth.output;
    plan.axes = {length.state, elevation.state, azimuth.state, yaw.state};
  }
  plan.command = within_limits(config.limits, here, plan.command);
  return plan;
}

HoldPlan plan_recommended(const HoldConfig& config, const HoldInput& input, const HoldAxes& axes,
                          const OwnMotion& own, double dt_s) {
  const RecommendedHoldConfig& recommended = config.recommended;
  const TetherState& here = input.tether->tether;
  HoldPlan plan{.turn_home_rad = turn_home_rad(*input.estimate, input.station_from_camera),
                .axes = position_at_rest(axes)};
  const LevelMotion change = predicted_change(recommended, input, axes, own);
  const PidStep yaw = step(recommended.yaw, axes[kYaw], plan.turn_home_rad + change[kYaw], dt_s);
  plan.axes[kYaw] = yaw.state;
  TetherCommand wanted;

  const std::optional<Vector3d> way = metric_way_home(recommended, input);
  if (std::abs(plan.turn_home_rad) > recommended.max_yaw_rad) {
    plan.reason = HoldReason::angle_first;
  } else if (!way) {
    plan.reason = HoldReason::displacement_unknown;
  } else {
    plan.way_home_in_station_m = *way;
    Vector3d velocity_m_s;
    if (const auto wanted_m_s = state_feedback(recommended, input, own, *way)) {
      velocity_m_s = *wanted_m_s;
    } else {
      for (int i = 0; i < 3; ++i) {
        const PidStep axis = step(recommended.position, axes[i], (*way)[i] + change[i], dt_s);
        plan.axes[i] = axis.state;
        velocity_m_s[i] = axis.output;
      }
    }
    wanted = rates_for_velocity(here, velocity_m_s, recommended.damped_within_m,
                                recommended.alignment_gain_1_m);
    const TetherCommand possible = within_limits(config.limits, here, wanted);
    plan.axes =
        without_windup(axes, plan.axes, velocity_m_s - velocity_in_station_m_s(here, possible));
  }
  wanted.yaw_rate_rad_s = yaw.output;
  plan.command = within_limits(config.limits, here, wanted);
  return plan;
}

}  // namespace stillkite
