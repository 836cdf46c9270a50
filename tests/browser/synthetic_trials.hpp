#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "io/report/hover_report.hpp"

namespace stillkite {

/// Twelve made-up trials in the shape of the hold paper's (section V): without stabilization the
/// drone follows its station, with it a fifth of the station's way is left and fades.
struct SyntheticTrials {
  std::vector<HoverReportTrial> trials;
  std::string config_yaml;

  [[nodiscard]] HoverReportContent content(const std::string& title) const;
};

[[nodiscard]] SyntheticTrials synthetic_trials();

/// A summary.json as a run of those trials would write it.
[[nodiscard]] nlohmann::json synthetic_hover_summary(const SyntheticTrials& trials);

}  // namespace stillkite
