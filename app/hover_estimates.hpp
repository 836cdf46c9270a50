#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

#include "simulation/hover/hover_trial.hpp"

namespace stillkite {

/// Estimation errors over all images of the trials: position_rmse_m, velocity_rmse_m_s,
/// velocity_p95_m_s, nees_mean (six degrees of freedom) and available_ratio (images with a
/// measurement). A figure without samples is null.
[[nodiscard]] nlohmann::json hover_estimate_json(std::span<const TrialRecord> records);

/// One row per image of every trial: estimation errors and estimated standard deviations.
[[nodiscard]] std::string hover_estimates_csv(std::span<const TrialRecord> records);

/// Text line of these figures.
[[nodiscard]] std::string hover_estimate_line(const nlohmann::json& estimate);

}  // namespace stillkite
