#include "app/study_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "evaluation/median_interval.hpp"

namespace stillkite {
namespace {

using nlohmann::json;

struct Group {
  std::string configuration;
  std::string estimator;
  std::string flight_group;  // empty: all
  std::vector<const json*> rows;
};

// In the order of their first rows.
std::vector<Group> grouped(const std::vector<json>& rows, bool by_flight) {
  std::vector<Group> groups;
  for (const json& row : rows) {
    const auto text = [&](const char* key) { return row[key].get<std::string>(); };
    const auto at = std::ranges::find_if(groups, [&](const Group& group) {
      return group.configuration == text("configuration") && group.estimator == text("estimator") &&
             (!by_flight || group.flight_group == text("flight_group"));
    });
    if (at != groups.end()) {
      at->rows.push_back(&row);
      continue;
    }
    groups.push_back({.configuration = text("configuration"),
                      .estimator = text("estimator"),
                      .flight_group = by_flight ? text("flight_group") : "",
                      .rows = {&row}});
  }
  return groups;
}

json statistics_of(const Group& group, const StudyMetric& metric) {
  const double sign = metric.worst == WorstValue::highest ? 1 : -1;
  std::vector<double> values;
  std::vector<double> badness;
  const json* worst = nullptr;
  for (const json* row : group.rows) {
    const auto value = figure_value(*row, metric.figure);
    if (!value) continue;
    if (badness.empty() || sign * *value > *std::ranges::max_element(badness)) worst = row;
    values.push_back(*value);
    badness.push_back(sign * *value);
  }
  const auto median = median_interval(values);
  if (!median) return {{"samples", 0}};
  const auto& interval = median->interval;
  return {{"samples", median->samples},
          {"median", median->median},
          {"low", interval ? json(interval->low) : json(nullptr)},
          {"high", interval ? json(interval->high) : json(nullptr)},
          {"nine_in_ten", sign * *nearest_rank_quantile(badness, 0.9)},
          {"worst", *figure_value(*worst, metric.figure)},
          {"worst_job", (*worst)["id"]},
          {"worst_results", (*worst)["results"]}};
}

json group_json(const Group& group, const std::vector<StudyMetric>& metrics) {
  json figures = json::object();
  for (const StudyMetric& metric : metrics) figures[metric.figure] = statistics_of(group, metric);
  const auto with_status = [&](const char* status) {
    return std::ranges::count_if(group.rows,
                                 [&](const json* row) { return (*row)["status"] == status; });
  };
  return {{"configuration", group.configuration},
          {"estimator", group.estimator},
          {"flight_group", group.flight_group},
          {"jobs", group.rows.size()},
          {"finished", with_status("finished")},
          {"failed", with_status("failed")},
          {"figures", figures}};
}

}  // namespace

std::optional<double> figure_value(const json& row, const std::string& figure) {
  const json& figures = row["figures"];
  const auto at = figures.find(figure);
  if (at == figures.end() || !at->is_number() || !std::isfinite(at->get<double>())) {
    return std::nullopt;
  }
  return at->get<double>();
}

json study_groups(const std::vector<json>& rows, const std::vector<StudyMetric>& metrics) {
  std::vector<Group> groups = grouped(rows, false);
  std::vector<Group> by_flight = grouped(rows, true);
  const auto has_several = [](const Group& group) { return group.rows.size() > 1; };
  if (by_flight.size() > groups.size() && std::ranges::any_of(by_flight, has_several)) {
    groups = std::move(by_flight);
  }
  json list = json::array();
  for (const Group& group : groups) list.push_back(group_json(group, metrics));
  return list;
}

}  // namespace stillkite
