#pragma once

#include "navigation/navigation_estimate.hpp"
#include "stabilization/hold_decision.hpp"

namespace stillkite {

/// HoverPilot's result for the command: HoldStep with the estimate's internal figures.
struct PilotStep {
  NavigationEstimate estimate;
  MotionEstimate motion;           ///< relative to the pose to hold, input of the decision
  bool is_setpoint_moved = false;  ///< by TetheredReadings::hold_here
  HoldDecision decision;
};

}  // namespace stillkite
