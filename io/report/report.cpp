#include "io/report/report.hpp"

#include <nlohmann/json.hpp>

#include "io/report/assets.hpp"
#include "io/report/base64.hpp"
#include "io/report/decimation.hpp"
#include "io/report/report_page.hpp"
#include "io/results/output_file.hpp"

namespace stillkite {
namespace {

using nlohmann::json;

/// Limit of the samples per chart column.
constexpr std::size_t kMaxSamples = 4000;

json columns(const ReportSeries& series) {
  json result = json::object();
  for (const auto& [name, values] : series) {
    result[name] = base64(keep_extremes(values, kMaxSamples));
  }
  return result;
}

/// Horizontal path, decimated by frames so that x and y of a sample belong together.
json path(const ReportSeries& series) {
  json result = json::object();
  for (const auto& [name, values] : series) {
    result[name] = base64(keep_every_nth(values, kMaxSamples));
  }
  return result;
}

json report_data(const FlightCharts& charts, const json& summary) {
  return {{"columns", columns(charts.columns)},
          {"path", path(charts.path)},
          {"verdicts", verdict_intervals_json(charts)},
          {"length_unit", charts.is_metric ? "m" : "heights"},
          {"has_truth", charts.has_truth},
          {"decimated", charts.frames > kMaxSamples},
          {"summary", summary}};
}

}  // namespace

std::string report_html(const ReportContent& content, const json& summary) {
  return report_page(
      {.brand = "Stillkite flight report",
       .main = report_assets::kReportMain,
       .style = report_assets::kReportStyle,
       .script = report_assets::kReportScript,
       .reset = "Show the whole flight",
       .footer =
           "Drag across a chart to zoom all charts, shift-drag to pan, double-click to reset; "
           "on a touch screen use two fingers.",
       .title = content.title,
       .config_yaml = content.config_yaml},
      report_data(content.charts, summary));
}

void write_report(const std::filesystem::path& path, const ReportContent& content,
                  const json& summary) {
  write_file(path, report_html(content, summary));
}

}  // namespace stillkite
