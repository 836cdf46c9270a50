#include "io/report/comparison_report.hpp"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "io/report/assets.hpp"
#include "io/report/base64.hpp"
#include "io/report/decimation.hpp"
#include "io/report/report_page.hpp"
#include "io/results/output_file.hpp"

namespace stillkite {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxComparedSamples = 3000;
/// Samples of a path whose columns are decimated.
constexpr std::size_t kMaxPathSamples = 2000;

/// The common frames of a column; a run that has failed has one frame less.
std::span<const float> common(const std::vector<float>& values, std::size_t frames) {
  return std::span(values).first(values.size() <= kMaxComparedSamples ? frames : values.size());
}

json drawn(std::span<const float> values) {
  return base64(keep_extremes(values, kMaxComparedSamples));
}

class RunCharts {
 public:
  RunCharts(const FlightCharts& charts, std::size_t frames) : charts_(charts), frames_(frames) {}

  [[nodiscard]] json column(const char* name) const { return drawn_of(charts_.columns, name); }
  [[nodiscard]] json norm(const char* name) const { return drawn_of(charts_.norms, name); }
  [[nodiscard]] json path(const char* name) const {
    const std::vector<float>& values = charts_.path.at(name);
    const bool is_whole = values.size() == charts_.frames;
    return base64(keep_every_nth(is_whole ? std::span(values).first(frames_) : std::span(values),
                                 is_whole ? kMaxComparedSamples : kMaxPathSamples));
  }

 private:
  [[nodiscard]] json drawn_of(const ReportSeries& series, const char* name) const {
    return drawn(common(series.at(name), frames_));
  }

  const FlightCharts& charts_;
  std::size_t frames_;
};

json true_columns(const RunCharts& charts) {
  return {{"speed_m_s", charts.norm("speed_true_m_s")},
          {"position_x_m", charts.column("position_true_x_m")},
          {"position_y_m", charts.column("position_true_y_m")},
          {"position_z_m", charts.column("position_true_z_m")}};
}

json run_columns(const RunCharts& charts, bool has_lengths, bool has_truth, bool is_metric) {
  json columns = json::object();
  if (has_lengths) {
    columns["speed_m_s"] = charts.norm("speed_m_s");
    for (const char* axis : {"position_x_m", "position_y_m", "position_z_m"}) {
      columns[axis] = charts.column(axis);
    }
  }
  if (!has_truth) return columns;
  columns["attitude_error_deg"] = charts.norm("attitude_error_deg");
  if (!is_metric) return columns;
  columns["position_error_m"] = charts.norm("position_error_m");
  columns["velocity_error_m_s"] = charts.norm("velocity_error_m_s");
  return columns;
}

json comparison_data(const ComparisonReportContent& content, const json& comparison) {
  std::size_t frames = std::numeric_limits<std::size_t>::max();
  bool any_metric = false;
  for (const ComparedCharts& run : content.runs) {
    frames = std::min({frames, run.charts.frames, run.frame_ms.size()});
    any_metric = any_metric || run.charts.is_metric;
  }
  if (content.runs.empty()) frames = 0;
  const bool has_truth = frames > 0 && content.runs.front().charts.has_truth;
  json data{{"length_unit", any_metric ? "m" : "heights"},
            {"has_truth", has_truth},
            {"decimated", frames > kMaxComparedSamples},
            {"runs", json::array()},
            {"summary", comparison}};
  for (const ComparedCharts& run : content.runs) {
    if (frames == 0) break;
    const RunCharts charts(run.charts, frames);
    const bool is_metric = run.charts.is_metric;
    const bool has_lengths = is_metric || !any_metric;
    json of_run{{"name", run.name},
                {"is_metric", is_metric},
                {"verdicts", verdict_intervals_json(run.charts)},
                {"columns", run_columns(charts, has_lengths, has_truth, is_metric)}};
    of_run["columns"]["frame_ms"] = drawn(run.frame_ms.first(frames));
    if (has_lengths) {
      of_run["path"] = {{"x", charts.path("position_x_m")}, {"y", charts.path("position_y_m")}};
    }
    data["runs"].push_back(std::move(of_run));
    data["time_s"] = charts.column("time_s");
    data["path_time_s"] = charts.path("time_s");
    if (!has_truth || !is_metric) continue;
    data["truth"] = {
        {"columns", true_columns(charts)},
        {"path",
         {{"x", charts.path("position_true_x_m")}, {"y", charts.path("position_true_y_m")}}}};
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
