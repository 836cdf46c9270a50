#pragma once

#include <optional>
#include <vector>

#include "estimation/sliding_window/sliding_window.hpp"
#include "navigation/inertial_finding.hpp"

namespace stillkite {

/// True if the accelerometer bias contradicts its prior (5-sigma equivalent, three degrees of
/// freedom).
[[nodiscard]] bool contradicts_prior(const InertialState& state, const InertialPriors& priors);

/// Accelerometer bias or camera rotation that contradicts its prior; empty without one, and before
/// the initialization.
[[nodiscard]] std::optional<InertialFinding> prior_contradiction(const SlidingWindow& window);

/// What the window has found so far.
[[nodiscard]] std::vector<InertialFinding> inertial_findings(const SlidingWindow& window);

}  // namespace stillkite
