#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "io/report/hover_report.hpp"

namespace stillkite {

/// Twelve synthetic trials as in the hold paper (section V): without stabilization the drone
/// follows its station; with stabilization by 20 % of the station's displacement.
struct SyntheticTrials {
  std::vector<HoverReportTrial> trials;
  std::string config_yaml;

  [[nodiscard]] HoverReportContent content(const std::string& title) const;
};

[[nodiscard]] SyntheticTrials synthetic_trials();

/// summary.json of the trials.
[[nodiscard]] nlohmann::json synthetic_hover_summary(const SyntheticTrials& trials);

}  // namespace stillkite
