#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "io/report/report_series.hpp"

namespace stillkite {

/// Content of a run report.
struct ReportContent {
  std::string title;  ///< source as given by the user
  FlightCharts charts;
  std::string config_yaml;  ///< effective configuration
};

/// Self-contained HTML page: figures 3 to 5 of the flow paper, errors against the truth, flow
/// quality, timing, verdicts, `summary` (summary.json) and configuration. Texts are escaped;
/// non-finite values become gaps.
[[nodiscard]] std::string report_html(const ReportContent& content, const nlohmann::json& summary);

/// Writes the page to a file; throws as write_file.
void write_report(const std::filesystem::path& path, const ReportContent& content,
                  const nlohmann::json& summary);

}  // namespace stillkite
