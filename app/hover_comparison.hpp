#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "navigation/navigator_config.hpp"
#include "simulation/hover/hover_trial.hpp"

namespace stillkite {

/// The trials that one of several estimators flew.
struct ComparedTrials {
  std::string name;
  std::vector<std::string> overrides;
  EstimatorConfig estimator;
  std::vector<TrialRecord> records;
  nlohmann::json summary;  ///< its summary.json
};

/// comparison.json of trials in closed loop. Of each estimator the mean over its stabilized trials
/// of a trial's mean |d|, along each of the paper's axes and in all, with the 95 % interval of
/// Student's t; and of every pair the same of the differences between trials of the same seed. The
/// verdicts are those of comparison_json. What is unknown is null.
[[nodiscard]] nlohmann::json hover_comparison_json(std::span<const ComparedTrials> estimators);

/// Its figures for a person, in cm.
[[nodiscard]] std::string hover_comparison_table(const nlohmann::json& comparison);

}  // namespace stillkite
