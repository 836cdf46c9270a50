#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "io/report/report.hpp"

namespace stillkite {

/// Named columns, one value a frame; NaN where there is none. Names end in their unit.
using ReportSeries = std::map<std::string, std::vector<float>>;

/// What the charts of a report draw over time: time from the first frame, pose, velocity in the
/// world, their standard deviations, flow quality, times; with truth also the truth and the errors
/// (estimate minus truth). Angles are unwrapped along the flight.
[[nodiscard]] ReportSeries report_series(const ReportContent& content);

/// One verdict's stretch of frames, seconds from the first frame.
struct VerdictStretch {
  Verdict verdict;
  double start_s;
  double end_s;
};
[[nodiscard]] std::vector<VerdictStretch> verdict_stretches(
    std::span<const NavigationEstimate> estimates);

/// The same for a page: [[verdict, start_s, end_s], ...].
[[nodiscard]] nlohmann::json verdict_stretches_json(std::span<const NavigationEstimate> estimates);

/// Lengths in heights are not to be drawn beside, or subtracted from, true ones in metres.
[[nodiscard]] bool is_in_metres(std::span<const NavigationEstimate> estimates);

}  // namespace stillkite
