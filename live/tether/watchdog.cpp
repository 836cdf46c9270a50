#include "live/tether/watchdog.hpp"

namespace stillkite {

void TetherWatchdog::receive(const TetherOrder& order, Timestamp now) {
  if (has_ended_ || last_.is_stopped) return;
  if (order.is_stopped || (last_.is_engaged && !order.is_engaged)) {
    inactive_since_ = now;
    inactive_reason_ = order.is_stopped ? HoldReason::stopped : HoldReason::not_engaged;
  }
  last_ = order;
  last_order_ = now;
  if (order.is_measured) last_measured_ = now;
}

void TetherWatchdog::end(Timestamp now) {
  if (last_.is_engaged && !last_.is_stopped) {
    inactive_since_ = now;
    inactive_reason_ = HoldReason::estimator_ended;
  }
  has_ended_ = true;
}

TetherWatchdog::Output TetherWatchdog::output(Timestamp now) const {
  const TetherCommand zero;
  if (has_ended_ || last_.is_stopped || !last_.is_engaged) {
    const bool repeats = inactive_since_ && seconds_between(*inactive_since_, now) <= kRepeat_s;
    return {repeats ? std::optional(zero) : std::nullopt, inactive_reason_};
  }
  if (seconds_between(last_order_, now) > kSilence_s) return {zero, HoldReason::estimator_silent};
  if (!last_measured_ || seconds_between(*last_measured_, now) > max_unmeasured_s_) {
    return {zero, HoldReason::not_measured};
  }
  return {last_.command, HoldReason::none};
}

}  // namespace stillkite
