#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

#include "simulation/hover/hover_trial.hpp"

namespace stillkite {

/// How the yaw came back: every kick of the stabilized flights with the time from its beginning
/// until the yaw is within 3 degrees of the start's to stay there until the next kick, and the yaw
/// in the figures of Table I. Null where nothing was kicked.
[[nodiscard]] nlohmann::json orientation_summary(std::span<const TrialRecord> records);

/// Its main figures, for a person; empty where it is null.
[[nodiscard]] std::string orientation_table(const nlohmann::json& orientation);

}  // namespace stillkite
