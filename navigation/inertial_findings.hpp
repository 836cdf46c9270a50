#pragma once

#include <vector>

#include "estimation/sliding_window/sliding_window.hpp"
#include "navigation/inertial_finding.hpp"

namespace stillkite {

/// True if the accelerometer bias contradicts its prior (5-sigma equivalent, three degrees of
/// freedom).
[[nodiscard]] bool contradicts_prior(const InertialState& state, const InertialPriors& priors);

/// What the window has found so far.
[[nodiscard]] std::vector<InertialFinding> inertial_findings(const SlidingWindow& window);

}  // namespace stillkite
