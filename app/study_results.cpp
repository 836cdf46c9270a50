#include "app/study_results.hpp"

#include <algorithm>
#include <fstream>
#include <set>
#include <tuple>

#include "app/study_statistics.hpp"
#include "app/variants.hpp"

namespace stillkite {
namespace fs = std::filesystem;
namespace {

using nlohmann::json;

const char* result_file(StudyCommand command) {
  switch (command) {
    case StudyCommand::compare:
      return "comparison.json";
    case StudyCommand::simulate:
      return "run.yaml";
    case StudyCommand::run:
    case StudyCommand::hover:
      break;
  }
  return "summary.json";
}

// Numbers and nulls of a result by their dotted paths.
json flat_figures(const json& result) {
  json figures = json::object();
  const json flat = result.flatten();
  for (const auto& [pointer, value] : flat.items()) {
    if (!value.is_number() && !value.is_null()) continue;
    std::string name = pointer.substr(std::min<std::size_t>(1, pointer.size()));
    std::replace(name.begin(), name.end(), '/', '.');
    figures[name] = value;
  }
  return figures;
}

std::string link_to(const fs::path& target, const fs::path& folder) {
  return fs::exists(target) ? target.lexically_relative(folder).generic_string() : "";
}

// One per estimator of a comparison, else one without a name.
std::vector<std::string> estimators_of(const Study& study) {
  if (study.command != StudyCommand::compare) return {""};
  std::vector<std::string> names;
  const auto list = study.estimators.empty() ? std::nullopt : std::optional(study.estimators);
  for (const VariantName& variant : parse_variants(list)) names.push_back(variant.name);
  return names;
}

// Numbers of the results, of a comparison those of one estimator.
json figures_of(StudyCommand command, const fs::path& results, const std::string& estimator) {
  if (command == StudyCommand::simulate) return json::object();
  const json result = json::parse(std::ifstream(results / result_file(command)));
  if (estimator.empty()) return flat_figures(result);
  for (const json& entry : result.at("estimators")) {
    if (entry.at("name") == estimator) return flat_figures(entry);
  }
  return json::object();
}

json row_of(const Study& study, const Job& job, const std::string& estimator,
            const fs::path& folder) {
  const JobFiles files(folder, job.id);
  const auto record = record_of(study, job, files);
  const bool is_finished = record && !record->failure;
  std::string page = link_to(files.results / estimator / "report.html", folder);
  if (page.empty()) page = link_to(files.results, folder);
  const bool has_messages = fs::exists(files.messages) && !fs::is_empty(files.messages);
  return {{"id", job.id},
          {"flight", job.flight},
          {"flight_group", job.flight_group},
          {"configuration", job.configuration},
          {"estimator", estimator},
          {"seed", job.seed.empty() ? json(nullptr) : json(std::stoll(job.seed))},
          {"status", is_finished ? "finished"
                     : record    ? "failed"
                                 : "pending"},
          {"failure", record && record->failure ? json(*record->failure) : json(nullptr)},
          {"wall_s", record ? json(record->wall_s) : json(nullptr)},
          {"results", page},
          {"messages", has_messages ? link_to(files.messages, folder) : ""},
          {"figures",
           is_finished ? figures_of(study.command, files.results, estimator) : json::object()}};
}

// Failed, without a value, worst to best, pending.
void sort_worst_first(std::vector<json>& rows, const std::vector<StudyMetric>& metrics) {
  const auto key = [&](const json& row) {
    const bool is_finished = row["status"] == "finished";
    const auto value =
        is_finished && !metrics.empty() ? figure_value(row, metrics.front().figure) : std::nullopt;
    const int group = row["status"] == "failed" ? 0 : !is_finished ? 3 : value ? 2 : 1;
    const bool is_highest = metrics.empty() || metrics.front().worst == WorstValue::highest;
    return std::tuple(group, (is_highest ? -1 : 1) * value.value_or(0));
  };
  std::stable_sort(rows.begin(), rows.end(),
                   [&](const json& a, const json& b) { return key(a) < key(b); });
}

json metrics_json(const std::vector<StudyMetric>& metrics) {
  json list = json::array();
  for (const StudyMetric& metric : metrics) {
    list.push_back({{"figure", metric.figure}, {"worst", name_of(metric.worst)}});
  }
  return list;
}

}  // namespace

std::optional<JobRecord> record_of(const Study& study, const Job& job, const JobFiles& files) {
  auto record = read_job_record(files.record, job.hash);
  const bool has_results = fs::exists(files.results / result_file(study.command));
  if (record && !record->failure && !has_results) record.reset();
  return record;
}

json study_json(const Study& study, std::span<const Job> jobs, const fs::path& folder) {
  std::vector<json> rows;
  const std::vector<std::string> estimators = estimators_of(study);
  for (const Job& job : jobs) {
    for (const std::string& estimator : estimators) {
      rows.push_back(row_of(study, job, estimator, folder));
    }
  }
  const json groups = study_groups(rows, study.metrics);
  sort_worst_first(rows, study.metrics);
  return {{"schema_version", 1},
          {"command", name_of(study.command)},
          {"metrics", metrics_json(study.metrics)},
          {"groups", groups},
          {"jobs", rows}};
}

std::string study_csv(const json& study) {
  std::set<std::string> names;
  for (const json& row : study["jobs"]) {
    for (const auto& [name, value] : row["figures"].items()) {
      if (value.is_number()) names.insert(name);
    }
  }
  std::string text = "#id,flight,configuration,estimator,seed,status,wall_s";
  for (const std::string& name : names) text += ',' + name;
  for (const json& row : study["jobs"]) {
    text += '\n';
    for (const char* name : {"id", "flight", "configuration", "estimator"}) {
      text += row[name].get<std::string>() + ',';
    }
    const auto number = [](const json& value) { return value.is_number() ? value.dump() : ""; };
    text +=
        number(row["seed"]) + ',' + row["status"].get<std::string>() + ',' + number(row["wall_s"]);
    for (const std::string& name : names) {
      text += ',' + number(row["figures"].value(name, json(nullptr)));
    }
  }
  return text + '\n';
}

}  // namespace stillkite
