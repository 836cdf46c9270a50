#pragma once

#include <string>
#include <vector>

#include "flow/frame.hpp"
#include "io/report/hover_report.hpp"
#include "simulation/hover/hover_trial.hpp"

namespace stillkite {

/// Thumbnail of a camera frame.
[[nodiscard]] HoverImage hover_image(const Frame& frame);

/// Trials in the report's format; takes over the images.
[[nodiscard]] std::vector<HoverReportTrial> hover_report_trials(
    const std::vector<TrialRecord>& records, std::vector<std::vector<HoverImage>> images,
    const std::string& policy);

}  // namespace stillkite
