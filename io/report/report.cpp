#include "io/report/report.hpp"

#include <nlohmann/json.hpp>

#include "io/report/assets.hpp"
#include "io/report/base64.hpp"
#include "io/report/decimation.hpp"
#include "io/report/report_page.hpp"
#include "io/report/report_series.hpp"
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
  for (const char* name :
       {"time_s", "position_x_m", "position_y_m", "position_true_x_m", "position_true_y_m"}) {
    const auto column = series.find(name);
    if (column != series.end()) {
      result[name] = base64(keep_every_nth(column->second, kMaxSamples));
    }
  }
  return result;
}

json report_data(const ReportContent& content, const json& summary) {
  const ReportSeries series = report_series(content);
  return {{"columns", columns(series)},
          {"path", path(series)},
          {"verdicts", verdict_intervals_json(content.estimates)},
          {"length_unit", is_in_metres(content.estimates) ? "m" : "heights"},
          {"has_truth", !content.truth.empty()},
          {"decimated", content.estimates.size() > kMaxSamples},
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
      report_data(content, summary));
}

void write_report(const std::filesystem::path& path, const ReportContent& content,
                  const json& summary) {
  write_file(path, report_html(content, summary));
}

}  // namespace stillkite
