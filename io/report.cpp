#include "io/report.hpp"

#include <map>
#include <nlohmann/json.hpp>
#include <string_view>

#include "io/base64.hpp"
#include "io/decimation.hpp"
#include "io/output_file.hpp"
#include "io/report/assets.hpp"
#include "io/report_series.hpp"

namespace stillkite {
namespace {

using nlohmann::json;

/// More samples than this no screen can show.
constexpr std::size_t kMaxSamples = 4000;

std::string escape_html(std::string_view text) {
  std::string escaped;
  escaped.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

/// JSON that may stand inside a script element: no "<" can end it.
std::string script_json(const json& value) {
  std::string text;
  for (const char c : value.dump(-1, ' ', false, json::error_handler_t::replace)) {
    if (c == '<') {
      text += "\\u003c";
    } else {
      text += c;
    }
  }
  return text;
}

json columns(const ReportSeries& series) {
  json result = json::object();
  for (const auto& [name, values] : series) {
    result[name] = base64(keep_extremes(values, kMaxSamples));
  }
  return result;
}

/// The path seen from above; unlike the columns, x and y of a sample are of one frame.
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

json verdicts(std::span<const NavigationEstimate> estimates) {
  json stretches = json::array();
  for (const VerdictStretch& stretch : verdict_stretches(estimates)) {
    stretches.push_back({name_of(stretch.verdict), stretch.start_s, stretch.end_s});
  }
  return stretches;
}

json report_data(const ReportContent& content, const json& summary) {
  const ReportSeries series = report_series(content);
  const bool metric =
      !content.estimates.empty() && content.estimates.back().scale != ScaleSource::none;
  return {{"columns", columns(series)},
          {"path", path(series)},
          {"verdicts", verdicts(content.estimates)},
          {"length_unit", metric ? "m" : "heights"},
          {"has_truth", !content.truth.empty()},
          {"decimated", content.estimates.size() > kMaxSamples},
          {"summary", summary}};
}

/// The template with each `{{name}}` replaced, in one pass: no mark is looked for in the texts.
std::string expand(std::string_view page, const std::map<std::string_view, std::string>& texts) {
  std::string result;
  for (std::size_t from = 0;;) {
    const std::size_t open = page.find("{{", from);
    result += page.substr(from, open - from);
    if (open == std::string_view::npos) return result;
    const std::size_t close = page.find("}}", open);
    result += texts.at(page.substr(open + 2, close - open - 2));
    from = close + 2;
  }
}

}  // namespace

std::string report_html(const ReportContent& content, const json& summary) {
  return expand(report_assets::kPage,
                {{"title", escape_html(content.title)},
                 {"config", escape_html(content.config_yaml)},
                 {"data", script_json(report_data(content, summary))},
                 {"style", std::string(report_assets::kStyle)},
                 {"script", std::string(report_assets::kScript)},
                 {"dygraphs_style", std::string(report_assets::kDygraphsStyle)},
                 {"dygraphs", std::string(report_assets::kDygraphs)}});
}

void write_report(const std::filesystem::path& path, const ReportContent& content,
                  const json& summary) {
  write_file(path, report_html(content, summary));
}

}  // namespace stillkite
