#pragma once

#include <optional>

#include "stabilization/held_tether.hpp"
#include "stabilization/hold_config.hpp"
#include "stabilization/hold_decision.hpp"
#include "stabilization/hold_plan.hpp"
#include "stabilization/velocity_model.hpp"

namespace stillkite {

/// From what is known of the camera's way from its place to rates of the tether that bring it back
/// (hold paper, section IV; docs/hold_controller.md).
///
/// Each decision commands or holds with a reason, and is within the vehicle's limits whatever came
/// in. It is taken to be obeyed until the next.
class HoldController {
 public:
  /// Throws InputError where the ends of the tether's length exclude each other.
  explicit HoldController(const HoldConfig& config);

  /// At a control instant. A clock that runs backwards starts afresh.
  [[nodiscard]] HoldDecision decide(const HoldInput& latest);

 private:
  [[nodiscard]] double advance(Timestamp now);
  [[nodiscard]] HoldPlan plan(const HoldInput& input, HoldReason reason, double dt_s);
  [[nodiscard]] VehicleLimits take_limits(const TetherReading& reading);
  [[nodiscard]] bool keeps_by_commands() const;

  HoldConfig config_;
  HoldMemory memory_;
  VelocityModel own_;
  HeldTether held_;
  std::optional<Timestamp> last_;
  std::optional<Timestamp> last_moved_;  // when the position was controlled last
  std::optional<double> taut_length_m_;  // read last while the tether was taut
};

}  // namespace stillkite
