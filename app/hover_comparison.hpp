#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "navigation/navigator_config.hpp"
#include "simulation/hover/hover_trial.hpp"

namespace stillkite {

/// Trials of one estimator.
struct ComparedTrials {
  std::string name;
  std::vector<std::string> overrides;
  EstimatorConfig estimator;
  std::vector<TrialRecord> records;
  nlohmann::json summary;  ///< its summary.json
};

/// comparison.json of trials in closed loop. Per estimator: mean of the trials' mean |d| over the
/// stabilized trials, per paper axis and overall, with the 95 % interval of Student's t. Per pair:
/// the same of the differences between trials of the same seed, with the verdicts of
/// comparison_json. Unavailable figures are null.
[[nodiscard]] nlohmann::json hover_comparison_json(std::span<const ComparedTrials> estimators);

/// Text table of its figures, cm.
[[nodiscard]] std::string hover_comparison_table(const nlohmann::json& comparison);

}  // namespace stillkite
