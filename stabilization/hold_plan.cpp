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

HoldAxes position_integrals_and_yaw(const HoldAxes& axes) {
  return {integral_of(axes[0]), integral_of(axes[1]), integral_of(axes[2]), axes[kYaw]};
}

// Unit vector along the position error; nullopt for a zero displacement.
std::optional<Vector3d> error_direction(const HoldInput& input) {
  const Vector3d error = position_error_in_station(*input.estimate, input.station_from_camera);
  const double length = error.stableNorm();
  if (!(length > 1e-9)) return std::nullopt;
  return Vector3d(error / length);
}

// No action while the mean shift and all angles are below their thresholds. The paper tests all
// three angles, although only yaw can be commanded.
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

// Position error, m, limited to `max_displacement_m`; nullopt if the displacement is unknown.
std::optional<Vector3d> metric_position_error(const RecommendedHoldConfig& config,
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
  const std::optional<Vector3d> direction = error_direction(input);
  if (!direction) {
    return estimate.displacement_kind == DisplacementKind::metric
               ? std::optional<Vector3d>(Vector3d::Zero())
               : std::nullopt;
  }
  return Vector3d(*direction * std::min(length_m, config.max_displacement_m));
}

// Growth rate of the errors without commands, as estimated by the integrals.
TranslationYaw integrated_drift(const HoldAxes& axes) {
  return {axes[0].integral, axes[1].integral, axes[2].integral, axes[kYaw].integral};
}

// Change of the errors since the exposure: constant drift minus the drone's modelled motion.
TranslationYaw change_since_exposure(const HoldInput& input, const TranslationYaw& drift,
                                     const VelocityModel& velocity_model) {
  const Timestamp exposure = input.estimate->stamp;
  return drift * seconds_between(exposure, input.now) - velocity_model.displacement_since(exposure);
}

// Change of the errors since the exposure and over the lag: the drone still coasts by lag x rate.
TranslationYaw predicted_change(const RecommendedHoldConfig& config, const HoldInput& input,
                                const HoldAxes& axes, const VelocityModel& velocity_model) {
  if (!config.predict) return TranslationYaw::Zero();
  const TranslationYaw drift = integrated_drift(axes);
  return change_since_exposure(input, drift, velocity_model) +
         config.lag_s * (drift - velocity_model.rate());
}

// Position error now, and its growth rate without commands (station and wind).
struct CurrentError {
  Vector3d position_m;
  Vector3d drift_m_s;
  bool drift_is_measured;  // from the estimate's velocity
};

CurrentError error_now(const RecommendedHoldConfig& config, const HoldInput& input,
                       const HoldAxes& axes, const VelocityModel& velocity_model,
                       const Vector3d& error_at_exposure_m) {
  if (!config.predict) return {error_at_exposure_m, Vector3d::Zero(), false};
  TranslationYaw drift = integrated_drift(axes);
  const std::optional<Vector3d> velocity_m_s =
      velocity_in_station_m_s(*input.estimate, input.station_from_camera);
  if (velocity_m_s) {
    drift.head<3>() = velocity_model.rate_at(input.estimate->stamp).head<3>() - *velocity_m_s;
  }
  return {error_at_exposure_m + change_since_exposure(input, drift, velocity_model).head<3>(),
          drift.head<3>(), velocity_m_s.has_value()};
}

// Lead of the command over the velocity for a unit acceleration over one step.
double lead_s(double lag_s, double dt_s) {
  if (!(dt_s > 0)) return lag_s;
  return lag_s > 0 ? -dt_s / std::expm1(-dt_s / lag_s) : dt_s;
}

// Velocity command for d'' = -2 p d' - p^2 d behind the lag w' = (u - w) / lag.
Vector3d state_feedback(const RecommendedHoldConfig& config, const CurrentError& error,
                        const VelocityModel& velocity_model, double dt_s) {
  const double pole = config.state_feedback_pole_1_s;
  const Vector3d modelled_velocity = velocity_model.rate().head<3>();
  const Vector3d velocity = modelled_velocity - error.drift_m_s;
  return modelled_velocity +
         lead_s(config.lag_s, dt_s) * (pole * pole * error.position_m - 2 * pole * velocity);
}

Vector3d low_passed(const Vector3d& mean, const Vector3d& value, double time_constant_s,
                    double dt_s) {
  return time_constant_s > 0 ? Vector3d(mean - std::expm1(-dt_s / time_constant_s) * (value - mean))
                             : value;
}

// Predictive azimuth rate near the zenith, for a target that moves with the mean drift. The radius
// is where that drift requires half of the azimuth's rate limit.
ZenithAzimuth zenith_azimuth(const HoldConfig& config, const TetherState& here,
                             const Vector3d& error_m, const Vector3d& drift_m_s) {
  const RecommendedHoldConfig& recommended = config.recommended;
  const double limit_rad_s = config.limits.azimuth_rate_rad_s;
  const double radius_m =
      std::max(recommended.damped_within_m, drift_m_s.head<2>().norm() / (limit_rad_s / 2));
  if (std::abs(tether_levers_m(here)[2]) > radius_m) return {radius_m, 0};
  const Vector3d target_m = position_in_station(here) + error_m;
  return {radius_m, azimuth_to_displacement_rad_s(
                        here.azimuth_rad, {target_m.head<2>(), drift_m_s.head<2>()},
                        {limit_rad_s, recommended.lag_s}, recommended.overhead_horizon_s)};
}

// Anti-windup: removes the integrals' growth along the velocity that the limits cut off.
HoldAxes without_windup(const HoldAxes& before, const HoldAxes& after, const Vector3d& deficit) {
  HoldAxes axes = after;
  const double length = deficit.norm();
  if (!(length > 1e-9)) return axes;
  const Vector3d direction = deficit / length;
  Vector3d growth;
  for (int i = 0; i < 3; ++i) growth[i] = after[i].integral - before[i].integral;
  growth -= std::max(0.0, growth.dot(direction)) * direction;
  for (int i = 0; i < 3; ++i) axes[i].integral = before[i].integral + growth[i];
  return axes;
}

}  // namespace

PidState integral_of(const PidState& state) {
  return {.integral = state.integral};
}

HoldPlan plan_paper(const HoldConfig& config, const HoldInput& input, const HoldState& before,
                    double dt_s) {
  const PaperHoldConfig& paper = config.paper;
  const TetherState& here = input.tether->tether;
  const EulerAngles angles = paper_angles(*input.estimate);
  HoldPlan plan{.reason = paper_reason(paper, *input.estimate, angles),
                .yaw_error_rad = -angles.pitch_rad,
                .state = {.axes = position_integrals_and_yaw(before.axes)}};
  if (plan.reason == HoldReason::within_dead_band) {
    plan.state.axes[kYaw] = integral_of(before.axes[kYaw]);
    return plan;
  }
  const PidStep yaw = step(paper.yaw, before.axes[kYaw], plan.yaw_error_rad, dt_s);
  plan.state.axes[kYaw] = yaw.state;
  plan.command.yaw_rate_rad_s = yaw.output;

  const std::optional<Vector3d> direction = error_direction(input);
  if (plan.reason == HoldReason::none && !direction) {
    plan.reason = HoldReason::displacement_unknown;
  }
  if (plan.reason == HoldReason::none) {
    // desired position in the station's frame: the measured one plus the unit translation
    plan.position_error_in_station_m = paper.unit_translation_m * *direction;
    const TetherState desired =
        tether_to(position_in_station(here) + plan.position_error_in_station_m, here);
    const PidStep length =
        step(paper.length, before.axes[0], desired.length_m - here.length_m, dt_s);
    const PidStep elevation =
        step(paper.elevation, before.axes[1], desired.elevation_rad - here.elevation_rad, dt_s);
    const PidStep azimuth =
        step(paper.azimuth, before.axes[2], desired.azimuth_rad - here.azimuth_rad, dt_s);
    plan.command.length_rate_m_s = length.output;
    plan.command.elevation_rate_rad_s = elevation.output;
    plan.command.azimuth_rate_rad_s = azimuth.output;
    plan.state.axes = {length.state, elevation.state, azimuth.state, yaw.state};
  }
  plan.command = within_limits(config.limits, here, plan.command);
  return plan;
}

HoldPlan plan_recommended(const HoldConfig& config, const HoldInput& input, const HoldState& before,
                          const VelocityModel& velocity_model, double dt_s) {
  const RecommendedHoldConfig& recommended = config.recommended;
  const TetherState& here = input.tether->tether;
  HoldPlan plan{.yaw_error_rad = yaw_error_rad(*input.estimate, input.station_from_camera),
                .state = {position_integrals_and_yaw(before.axes), before.drift_in_station_m_s}};
  HoldAxes& axes = plan.state.axes;
  const TranslationYaw change = predicted_change(recommended, input, before.axes, velocity_model);
  const PidStep yaw =
      step(recommended.yaw, before.axes[kYaw], plan.yaw_error_rad + change[kYaw], dt_s);
  axes[kYaw] = yaw.state;
  TetherCommand desired;

  const std::optional<Vector3d> error_m = metric_position_error(recommended, input);
  if (std::abs(plan.yaw_error_rad) > recommended.max_yaw_rad) {
    plan.reason = HoldReason::angle_first;
  } else if (!error_m) {
    plan.reason = HoldReason::displacement_unknown;
  } else {
    plan.position_error_in_station_m = *error_m;
    const CurrentError now = error_now(recommended, input, before.axes, velocity_model, *error_m);
    Vector3d velocity_m_s;
    if (now.drift_is_measured && recommended.state_feedback_pole_1_s > 0) {
      velocity_m_s = state_feedback(recommended, now, velocity_model, dt_s);
    } else {
      for (int i = 0; i < 3; ++i) {
        const PidStep axis =
            step(recommended.position, before.axes[i], (*error_m)[i] + change[i], dt_s);
        axes[i] = axis.state;
        velocity_m_s[i] = axis.output;
      }
    }
    Vector3d& drift = plan.state.drift_in_station_m_s;
    drift = low_passed(drift, now.drift_m_s, recommended.drift_memory_s, dt_s);
    desired = rates_for_velocity(here, velocity_m_s, recommended.damped_within_m,
                                 zenith_azimuth(config, here, now.position_m, drift));
    const TetherCommand possible = within_limits(config.limits, here, desired);
    axes =
        without_windup(before.axes, axes, velocity_m_s - velocity_in_station_m_s(here, possible));
  }
  desired.yaw_rate_rad_s = yaw.output;
  plan.command = within_limits(config.limits, here, desired);
  return plan;
}

}  // namespace stillkite
