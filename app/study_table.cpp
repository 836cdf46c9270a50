#include "app/study_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "io/config/config_values.hpp"

namespace stillkite {
namespace {

using nlohmann::json;

std::string number_or_dash(const json& value) {
  return value.is_number() ? fmt::format("{:.4g}", value.get<double>()) : "-";
}

std::string group_label(const json& group) {
  std::string label;
  for (const char* part : {"flight_group", "configuration", "estimator"}) {
    const auto& name = group[part].get_ref<const std::string&>();
    if (!name.empty()) label += (label.empty() ? "" : ", ") + name;
  }
  return label.empty() ? "all" : label;
}

std::string table_row(const json& group, const json& found, std::size_t width) {
  const std::string jobs = fmt::format("{}/{}", found["samples"].dump(), group["jobs"].dump());
  if (found["samples"] == 0)
    return fmt::format("  {:<{}} {:>9}\n", group_label(group), width, jobs);
  const std::string interval = found["low"].is_null() ? "-"
                                                      : number_or_dash(found["low"]) + " to " +
                                                            number_or_dash(found["high"]);
  return fmt::format("  {:<{}} {:>9}{:>11}{:>24}{:>11}{:>11}  {}\n", group_label(group), width,
                     jobs, number_or_dash(found["median"]), interval,
                     number_or_dash(found["nine_in_ten"]), number_or_dash(found["worst"]),
                     found["worst_job"].get<std::string>());
}

bool is_known(const json& figures, std::string figure) {
  if (figures.contains(figure)) return true;
  // null: the group has no value in this result
  for (std::size_t dot; (dot = figure.rfind('.')) != std::string::npos;) {
    figure.resize(dot);
    if (figures.contains(figure)) return true;
  }
  return false;
}

}  // namespace

std::string study_table(const json& study) {
  std::size_t width = 0;
  for (const json& group : study["groups"]) width = std::max(width, group_label(group).size());
  std::string text;
  for (const json& metric : study["metrics"]) {
    const std::string figure = metric["figure"].get<std::string>();
    text += fmt::format("{}{}\n  {:<{}} {:>9}{:>11}{:>24}{:>11}{:>11}\n", figure,
                        metric["worst"] == "lowest" ? " (worst: lowest)" : "", "", width, "jobs",
                        "median", "95 % interval", "9 in 10", "worst");
    for (const json& group : study["groups"]) {
      text += table_row(group, group["figures"][figure], width);
    }
  }
  return text;
}

std::vector<std::string> unknown_metrics(const json& study) {
  std::set<std::string> known;
  std::vector<std::string> unknown;
  for (const json& row : study["jobs"]) {
    for (const auto& [name, value] : row["figures"].items()) known.insert(name);
  }
  if (known.empty()) return unknown;
  const std::vector<std::string_view> names(known.begin(), known.end());
  for (const json& metric : study["metrics"]) {
    const std::string figure = metric["figure"].get<std::string>();
    const auto has_figure = [&](const json& row) { return is_known(row["figures"], figure); };
    if (std::ranges::any_of(study["jobs"], has_figure)) continue;
    const std::string_view near = nearest_name(figure, names);
    unknown.push_back(fmt::format("metrics: no result has '{}'{}", figure,
                                  near.empty() ? "; study.csv lists all figures"
                                               : fmt::format(", did you mean '{}'?", near)));
  }
  return unknown;
}

}  // namespace stillkite
