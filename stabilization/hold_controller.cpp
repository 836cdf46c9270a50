#include "stabilization/hold_controller.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "stabilization/hold_errors.hpp"
#include "stabilization/tether_rates.hpp"

namespace stillkite {
namespace {

// A longer step would let one estimate wind up an integral.
constexpr double kLongestStep_s = 0.5;

HoldConfig checked(const HoldConfig& config) {
  if (config.limits.min_length_m < config.limits.max_length_m) return config;
  throw InputError("limits.min_length_m: " + std::to_string(config.limits.min_length_m) +
                   " is not below limits.max_length_m, " +
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

HoldReason reason_of(const HoldPlan& plan, const HoldInput& input) {
  if (plan.reason != HoldReason::none) return plan.reason;
  if (!input.tether->taut) return HoldReason::tether_slack;
  return all_zero(plan.command) ? HoldReason::within_dead_band : HoldReason::none;
}

HoldDecision decision_of(const HoldPlan& plan, const HoldInput& input) {
  return {.command = plan.command,
          .action = all_zero(plan.command) ? HoldAction::hold : HoldAction::command,
          .reason = reason_of(plan, input),
          .way_home_in_station_m = plan.way_home_in_station_m,
          .turn_home_rad = plan.turn_home_rad};
}

}  // namespace

HoldController::HoldController(const HoldConfig& config)
    : config_(checked(config)), own_(config.recommended.lag_s), held_(config.recommended.lag_s) {}

// What the commands have done is believed, and counts.
bool HoldController::keeps_by_commands() const {
  return config_.mode == HoldMode::recommended && config_.recommended.predict;
}

double HoldController::advance(Timestamp now) {
  if (last_ && now < *last_) *this = HoldController(config_);
  own_.advance(now);
  held_.advance(now);
  const double dt_s = last_ ? std::min(seconds_between(*last_, now), kLongestStep_s) : 0;
  last_ = now;
  if (last_moved_ && seconds_between(*last_moved_, now) > config_.forget_after_s) {
    memory_ = {};
    last_moved_.reset();
  }
  return dt_s;
}

// A slack tether that is paid out further moves nothing, or hangs low.
VehicleLimits HoldController::take_limits(const TetherReading& reading) {
  if (reading.taut || !taut_length_m_) taut_length_m_ = reading.tether.length_m;
  VehicleLimits limits = config_.limits;
  if (!reading.taut) {
    limits.max_length_m = std::min(limits.max_length_m, *taut_length_m_ + config_.max_slack_m);
  }
  return limits;
}

HoldPlan HoldController::plan(const HoldInput& input, HoldReason reason, double dt_s) {
  HoldPlan held{.reason = reason, .memory = memory_};
  for (PidState& axis : held.memory.axes) axis = at_rest(axis);
  if (held.reason != HoldReason::none) return held;
  HoldConfig config = config_;
  config.limits = take_limits(*input.tether);
  const HoldPlan plan = config.mode == HoldMode::paper
                            ? plan_as_in_paper(config, input, memory_, dt_s)
                            : plan_recommended(config, input, memory_, own_, dt_s);
  if (all_finite(plan.command)) return plan;
  held.reason = HoldReason::not_finite;
  return held;
}

HoldDecision HoldController::decide(const HoldInput& latest) {
  const double dt_s = advance(latest.now);
  const HoldReason reason = reason_to_hold(config_, latest);
  HoldInput input = latest;
  if (reason == HoldReason::none && keeps_by_commands()) {
    input.tether->tether = held_.take(latest.tether->tether);
  }
  const HoldPlan plan = this->plan(input, reason, dt_s);
  memory_ = plan.memory;
  LevelMotion commanded = LevelMotion::Zero();
  if (plan.reason == HoldReason::none) last_moved_ = input.now;
  if (!all_zero(plan.command)) {
    commanded << velocity_in_station_m_s(input.tether->tether, plan.command),
        plan.command.yaw_rate_rad_s;
  }
  own_.set_command(commanded);
  held_.set_command(plan.command);
  return decision_of(plan, input);
}

}  // namespace stillkite
