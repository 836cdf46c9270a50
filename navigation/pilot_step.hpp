#pragma once

#include "navigation/navigation_estimate.hpp"
#include "stabilization/hold_decision.hpp"

namespace stillkite {

/// HoverPilot's result for the command: HoldStep with the estimate's internal figures.
struct PilotStep {
  NavigationEstimate estimate;
  HoldDecision decision;
};

}  // namespace stillkite
