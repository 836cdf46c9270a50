#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

#include "simulation/hover/hover_trial.hpp"

namespace stillkite {

/// A trial's displacement along its moved axis, m, one a sample.
[[nodiscard]] std::vector<double> displacements_m(const TrialRecord& record);

/// summary.json of the trials: Table I of the hold paper, every trial, and how fast they were
/// flown.
[[nodiscard]] nlohmann::json hover_summary(std::span<const TrialRecord> records,
                                           const std::string& policy, double wall_s);

/// One row a trial; of a trial that was not flown nothing.
[[nodiscard]] std::string trials_csv(std::span<const TrialRecord> records,
                                     const std::string& policy);

/// One row a sample of every trial: truth, command and why.
[[nodiscard]] std::string samples_csv(std::span<const TrialRecord> records);

/// Table I beside the paper's.
[[nodiscard]] std::string hover_table(const nlohmann::json& summary);

}  // namespace stillkite
