#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

#include "simulation/hover/hover_trial.hpp"

namespace stillkite {

/// Signed displacement along the trial's moved axis, one per sample.
[[nodiscard]] std::vector<double> displacements_m(const TrialRecord& record);

/// summary.json of the trials: table I of the hold paper, every trial, and the real-time factor.
[[nodiscard]] nlohmann::json hover_summary(std::span<const TrialRecord> records,
                                           const std::string& policy, double wall_s);

/// One row per flown trial.
[[nodiscard]] std::string trials_csv(std::span<const TrialRecord> records,
                                     const std::string& policy);

/// One row per sample of every trial: truth, command and reason.
[[nodiscard]] std::string samples_csv(std::span<const TrialRecord> records);

/// Text of table I with the paper's figures.
[[nodiscard]] std::string hover_table(const nlohmann::json& summary);

}  // namespace stillkite
