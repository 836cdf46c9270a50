#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "io/report/report_series.hpp"

namespace stillkite {

/// Charts of one estimator on the common frames.
struct ComparedCharts {
  std::string name;
  FlightCharts charts;
  std::span<const float> frame_ms;  ///< one per frame
};

/// Content of a comparison report. Runs are cut to the shortest.
struct ComparisonReportContent {
  std::string title;  ///< configuration file as given by the user
  std::vector<ComparedCharts> runs;
  std::string config_yaml;  ///< effective configurations
};

/// Self-contained HTML page: table of comparison.json (`comparison`) with significance, verdicts
/// and overlaid charts, one colour per estimator. Texts are escaped; non-finite values become gaps.
/// Lengths of an estimator without metric scale are omitted if another one is metric.
[[nodiscard]] std::string comparison_report_html(const ComparisonReportContent& content,
                                                 const nlohmann::json& comparison);

/// Writes the page to a file; throws as write_file.
void write_comparison_report(const std::filesystem::path& path,
                             const ComparisonReportContent& content,
                             const nlohmann::json& comparison);

}  // namespace stillkite
