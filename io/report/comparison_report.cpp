#include "io/report/comparison_report.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
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

constexpr std::size_t kMaxComparedSamples = 3000;

/// Norms of vectors in three columns.
std::vector<float> norms_of(const ReportSeries& series, const std::string& name,
                            const std::string& unit) {
  const std::vector<float>& x = series.at(name + "_x_" + unit);
  const std::vector<float>& y = series.at(name + "_y_" + unit);
  const std::vector<float>& z = series.at(name + "_z_" + unit);
  std::vector<float> norms(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) norms[i] = std::hypot(x[i], y[i], z[i]);
  return norms;
}

json drawn(std::span<const float> values) {
  return base64(keep_extremes(values, kMaxComparedSamples));
}

json path_of(const ReportSeries& series, const std::string& name) {
  const auto thinned = [&](const char* axis) {
    return base64(keep_every_nth(series.at(name + axis), kMaxComparedSamples));
  };
  return {{"x", thinned("_x_m")}, {"y", thinned("_y_m")}};
}

json true_columns(const ReportSeries& series) {
  json columns{{"speed_m_s", drawn(norms_of(series, "velocity_true", "m_s"))}};
  for (const char* axis : {"x", "y", "z"}) {
    columns[std::string("position_") + axis + "_m"] =
        drawn(series.at(std::string("position_true_") + axis + "_m"));
  }
  return columns;
}

json run_columns(const ReportSeries& series, bool has_lengths, bool has_truth, bool is_metric) {
  json columns = json::object();
  if (has_lengths) {
    columns["speed_m_s"] = drawn(norms_of(series, "velocity", "m_s"));
    for (const char* axis : {"position_x_m", "position_y_m", "position_z_m"}) {
      columns[axis] = drawn(series.at(axis));
    }
  }
  if (!has_truth) return columns;
  columns["attitude_error_deg"] = drawn(norms_of(series, "attitude_error", "deg"));
  if (!is_metric) return columns;
  columns["position_error_m"] = drawn(norms_of(series, "position_error", "m"));
  columns["velocity_error_m_s"] = drawn(norms_of(series, "velocity_error", "m_s"));
  return columns;
}

json comparison_data(const ComparisonReportContent& content, const json& comparison) {
  std::size_t frames = std::numeric_limits<std::size_t>::max();
  bool any_metric = false;
  for (const ComparedEstimates& run : content.runs) {
    frames = std::min({frames, run.estimates.size(), run.frame_ms.size()});
    any_metric = any_metric || is_in_metres(run.estimates);
  }
  if (content.runs.empty()) frames = 0;
  const auto truth = content.truth.first(std::min(frames, content.truth.size()));
  json data{{"length_unit", any_metric ? "m" : "heights"},
            {"has_truth", !truth.empty()},
            {"decimated", frames > kMaxComparedSamples},
            {"runs", json::array()},
            {"summary", comparison}};
  for (const ComparedEstimates& run : content.runs) {
    const auto estimates = run.estimates.first(frames);
    if (frames == 0) break;
    const ReportSeries series = report_series({.estimates = estimates, .truth = truth});
    const bool is_metric = is_in_metres(run.estimates);
    const bool has_lengths = is_metric || !any_metric;
    json of_run{{"name", run.name},
                {"is_metric", is_metric},
                {"verdicts", verdict_intervals_json(estimates)},
                {"columns", run_columns(series, has_lengths, !truth.empty(), is_metric)}};
    of_run["columns"]["frame_ms"] = drawn(run.frame_ms.first(frames));
    if (has_lengths) of_run["path"] = path_of(series, "position");
    data["runs"].push_back(std::move(of_run));
    data["time_s"] = drawn(series.at("time_s"));
    data["path_time_s"] = base64(keep_every_nth(series.at("time_s"), kMaxComparedSamples));
    if (truth.empty() || !is_metric) continue;
    data["truth"] = {{"columns", true_columns(series)}, {"path", path_of(series, "position_true")}};
  }
  return data;
}

}  // namespace

std::string comparison_report_html(const ComparisonReportContent& content, const json& comparison) {
  return report_page(
      {.brand = "Stillkite comparison",
       .main = report_assets::kComparisonMain,
       .style = report_assets::kComparisonStyle,
       .script = report_assets::kComparisonScript,
       .reset = "Show the whole flight",
       .footer =
           "Drag across a chart to zoom all charts, shift-drag to pan, double-click to reset; "
           "on a touch screen use two fingers.",
       .title = content.title,
       .config_yaml = content.config_yaml},
      comparison_data(content, comparison));
}

void write_comparison_report(const std::filesystem::path& path,
                             const ComparisonReportContent& content, const json& comparison) {
  write_file(path, comparison_report_html(content, comparison));
}

}  // namespace stillkite
