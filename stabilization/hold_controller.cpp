#include "stabilization/hold_controller.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "stabilization/hold_errors.hpp"
#include "stabilization/tether_rates.hpp"

namespace stillkite {
namespace {

// Bounds the growth of the integrals from one estimate.
constexpr double kMaxStep_s = 0.5;

HoldConfig checked(const HoldConfig& config) {
  if (config.limits.min_length_m < config.limits.max_length_m) return config;
  throw InputError("limits.min_length_m: " + std::to_string(config.limits.min_length_m) +
                   " must be below limits.max_length_m, " +
                   std::to_string(config.limits.max_length_m));
}

bool all_finite(const TetherCommand& c) {
  return std::isfinite(c.length_rate_m_s) && std::isfinite(c.elevation_rate_rad_s) &&
         std::isfinite(c.azimuth_rate_rad_s) && std::isfinite(c.yaw_rate_rad_s);
}

bool all_zero(const TetherCommand& c) {
  return c.length_rate_m_s == 0 && c.elevation_rate_rad_s == 0 && c.azimuth_rate_rad_s == 0 &&
         c.yaw_rate_rad_s == 0;
}

bool is_beyond(const VehicleLimits& limits, const TetherState& tether) {
  return tether.length_m < limits.min_length_m || tether.length_m > limits.max_length_m ||
         tether.elevation_rad < limits.min_elevation_rad ||
         tether.elevation_rad > limits.max_elevation_rad();
}

HoldReason reason_of(const VehicleLimits& limits, const HoldPlan& plan, const HoldInput& input) {
  if (plan.reason != HoldReason::none) return plan.reason;
  if (is_beyond(limits, input.tether->tether)) return HoldReason::at_limit;
  if (!input.tether->taut) return HoldReason::tether_slack;
  return all_zero(plan.command) ? HoldReason::within_dead_band : HoldReason::none;
}

HoldDecision decision_of(const VehicleLimits& limits, const HoldPlan& plan,
                         const HoldInput& input) {
  return {.command = plan.command,
          .action = all_zero(plan.command) ? HoldAction::hold : HoldAction::command,
          .reason = reason_of(limits, plan, input),
          .position_error_in_station_m = plan.position_error_in_station_m,
          .yaw_error_rad = plan.yaw_error_rad};
}

}  // namespace

HoldController::HoldController(const HoldConfig& config)
    : config_(checked(config)),
      velocity_model_(config.recommended.lag_s),
      tether_model_(config.recommended.lag_s) {}

bool HoldController::uses_tether_model() const {
  return config_.mode == HoldMode::recommended && config_.recommended.predict;
}

double HoldController::advance(Timestamp now) {
  if (last_ && now < *last_) *this = HoldController(config_);
  velocity_model_.advance(now);
  tether_model_.advance(now);
  const double dt_s = last_ ? std::min(seconds_between(*last_, now), kMaxStep_s) : 0;
  last_ = now;
  if (last_position_control_ &&
      seconds_between(*last_position_control_, now) > config_.reset_integral_after_s) {
    state_ = {};
    last_position_control_.reset();
  }
  return dt_s;
}

// Paying out a slack tether does not move the drone; the tether sags.
VehicleLimits HoldController::update_limits(const TetherReading& reading) {
  if (reading.taut || !taut_length_m_) taut_length_m_ = reading.tether.length_m;
  VehicleLimits limits = config_.limits;
  if (!reading.taut) {
    limits.max_length_m = std::min(limits.max_length_m, *taut_length_m_ + config_.max_slack_m);
  }
  return limits;
}

HoldPlan HoldController::plan(const HoldInput& input, HoldReason reason, double dt_s) {
  HoldPlan hold{.reason = reason, .state = state_};
  for (PidState& axis : hold.state.axes) axis = integral_of(axis);
  if (hold.reason != HoldReason::none) return hold;
  HoldConfig config = config_;
  config.limits = update_limits(*input.tether);
  const HoldPlan plan = config.mode == HoldMode::paper
                            ? plan_paper(config, input, state_, dt_s)
                            : plan_recommended(config, input, state_, velocity_model_, dt_s);
  if (all_finite(plan.command)) return plan;
  hold.reason = HoldReason::not_finite;
  return hold;
}

HoldDecision HoldController::decide(const HoldInput& latest) {
  const double dt_s = advance(latest.now);
  const HoldReason reason = reason_to_hold(config_, latest);
  HoldInput input = latest;
  if (reason == HoldReason::none && uses_tether_model()) {
    input.tether->tether = tether_model_.update(latest.tether->tether);
  }
  HoldPlan plan = this->plan(input, reason, dt_s);
  if (reason == HoldReason::none) {
    // the measured direction counts for the limits; wind deflects it from the modelled one
    plan.command = within_limits(config_.limits, latest.tether->tether, plan.command);
  }
  state_ = plan.state;
  TranslationYaw commanded = TranslationYaw::Zero();
  if (plan.reason == HoldReason::none) last_position_control_ = input.now;
  if (!all_zero(plan.command)) {
    commanded << velocity_in_station_m_s(input.tether->tether, plan.command),
        plan.command.yaw_rate_rad_s;
  }
  velocity_model_.set_command(commanded);
  tether_model_.set_command(plan.command);
  return decision_of(config_.limits, plan, latest);
}

}  // namespace stillkite
