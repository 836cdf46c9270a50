#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

#include "simulation/hover/hover_trial.hpp"

namespace stillkite {

/// By how much the estimates of all these trials' images were off: position_rmse_m,
/// velocity_rmse_m_s, velocity_p95_m_s, nees_mean of six degrees of freedom, and the ratio of
/// images that told something. Null what no image has.
[[nodiscard]] nlohmann::json hover_estimate_json(std::span<const TrialRecord> records);

/// One row an image of every trial: what its estimate was off by and what it said of itself.
[[nodiscard]] std::string hover_estimates_csv(std::span<const TrialRecord> records);

/// One line for a person.
[[nodiscard]] std::string hover_estimate_line(const nlohmann::json& estimate);

}  // namespace stillkite
