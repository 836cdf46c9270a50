#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "io/report/report.hpp"

namespace stillkite {

/// Named columns, one value per frame, NaN if absent. Names end in the unit.
using ReportSeries = std::map<std::string, std::vector<float>>;

/// Time series of a report: time from the first frame, pose, velocity in the world, their standard
/// deviations, flow quality and stage times; with truth also truth and errors (estimate - truth).
/// Angles are unwrapped.
[[nodiscard]] ReportSeries report_series(const ReportContent& content);

/// Interval of frames with the same verdict, in seconds from the first frame.
struct VerdictInterval {
  Verdict verdict;
  double start_s;
  double end_s;
};
[[nodiscard]] std::vector<VerdictInterval> verdict_intervals(
    std::span<const NavigationEstimate> estimates);

/// Intervals as JSON: [[verdict, start_s, end_s], ...].
[[nodiscard]] nlohmann::json verdict_intervals_json(std::span<const NavigationEstimate> estimates);

/// True if the lengths are metric; otherwise they are in initial heights.
[[nodiscard]] bool is_in_metres(std::span<const NavigationEstimate> estimates);

}  // namespace stillkite
