#pragma once

#include <string>
#include <vector>

#include "flow/frame.hpp"
#include "io/report/hover_report.hpp"
#include "simulation/hover/hover_trial.hpp"

namespace stillkite {

/// A small image of what the drone's camera saw.
[[nodiscard]] HoverImage hover_image(const Frame& frame);

/// The trials as the report draws them, their images moved in.
[[nodiscard]] std::vector<HoverReportTrial> hover_report_trials(
    const std::vector<TrialRecord>& records, std::vector<std::vector<HoverImage>> images,
    const std::string& policy);

}  // namespace stillkite
