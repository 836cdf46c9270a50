#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

#include "simulation/hover/hover_trial.hpp"

namespace stillkite {

/// Yaw disturbance response of the stabilized flights: settling time to 3 degrees of the initial
/// yaw for every kick (until the next kick), and the yaw in the figures of table I. Null without
/// kicks.
[[nodiscard]] nlohmann::json orientation_summary(std::span<const TrialRecord> records);

/// Text table of its main figures; empty for null.
[[nodiscard]] std::string orientation_table(const nlohmann::json& orientation);

}  // namespace stillkite
