#pragma once

#include <string>
#include <vector>

#include "flow/frame.hpp"
#include "io/report/hover_report.hpp"
#include "simulation/hover/hover_trial.hpp"

namespace stillkite {

/// A small picture of what the drone's camera saw.
[[nodiscard]] HoverPicture hover_picture(const Frame& frame);

/// The trials as the report draws them, their pictures moved in.
[[nodiscard]] std::vector<HoverReportTrial> hover_report_trials(
    const std::vector<TrialRecord>& records, std::vector<std::vector<HoverPicture>> pictures,
    const std::string& policy);

}  // namespace stillkite
