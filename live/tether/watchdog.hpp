#pragma once

#include <optional>

#include "geometry/time.hpp"
#include "stabilization/hold_decision.hpp"
#include "stabilization/tether.hpp"

namespace stillkite {

/// Message of the estimator's process for each image, and for each change of engagement.
struct TetherOrder {
  bool is_engaged = false;
  bool is_stopped = false;   ///< for the rest of the flight
  bool is_measured = false;  ///< the image has been measured (verdict ok or still)
  TetherCommand command;     ///< zero while it is withheld
};

/// Safety rules of the process that owns the ground station's port. In this order:
/// - never engaged: nothing is sent;
/// - stopped, released, or the estimator's process has ended: zero rates for kRepeat_s, then
///   nothing; a stop is final;
/// - no order for kSilence_s, or none of a measured image for `max_unmeasured_s`: zero rates;
/// - else the last command.
class TetherWatchdog {
 public:
  static constexpr double kSilence_s = 0.3;
  static constexpr double kRepeat_s = 1.0;

  explicit TetherWatchdog(double max_unmeasured_s) : max_unmeasured_s_(max_unmeasured_s) {}

  void receive(const TetherOrder& order, Timestamp now);
  /// The estimator's process has ended.
  void end(Timestamp now);

  struct Output {
    std::optional<TetherCommand> command;  ///< nullopt: nothing is sent
    HoldReason reason = HoldReason::none;  ///< of zero rates; `none`: the estimator's command
  };
  [[nodiscard]] Output output(Timestamp now) const;

 private:
  double max_unmeasured_s_;
  TetherOrder last_;
  Timestamp last_order_;
  std::optional<Timestamp> last_measured_;
  std::optional<Timestamp> inactive_since_;  // after an engagement
  HoldReason inactive_reason_ = HoldReason::not_engaged;
  bool has_ended_ = false;
};

}  // namespace stillkite
