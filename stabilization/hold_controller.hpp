#pragma once

#include <optional>

#include "stabilization/hold_config.hpp"
#include "stabilization/hold_decision.hpp"
#include "stabilization/hold_plan.hpp"
#include "stabilization/tether_model.hpp"
#include "stabilization/velocity_model.hpp"

namespace stillkite {

/// Position hold: from the estimated displacement from the reference pose to tether rates that
/// reduce it (hold paper, section IV; docs/hold_control.md).
///
/// Each decision commands, or holds with a reason; it is within the vehicle's limits for any input.
/// The internal models assume that it is executed until the next one.
class HoldController {
 public:
  /// Throws InputError unless limits.min_length_m < limits.max_length_m.
  explicit HoldController(const HoldConfig& config);

  /// Decision at a control instant. Resets the controller if the clock runs backwards.
  [[nodiscard]] HoldDecision decide(const HoldInput& latest);

 private:
  [[nodiscard]] double advance(Timestamp now);
  [[nodiscard]] HoldPlan plan(const HoldInput& input, HoldReason reason, double dt_s);
  [[nodiscard]] VehicleLimits update_limits(const TetherReading& reading);
  [[nodiscard]] bool uses_tether_model() const;

  HoldConfig config_;
  HoldState state_;
  VelocityModel velocity_model_;
  TetherModel tether_model_;
  std::optional<Timestamp> last_;
  std::optional<Timestamp> last_position_control_;
  std::optional<double> taut_length_m_;  // last length measured with a taut tether
};

}  // namespace stillkite
