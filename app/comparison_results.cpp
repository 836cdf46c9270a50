#include "app/comparison_results.hpp"

namespace stillkite {
namespace {

using nlohmann::json;

void add_differences(json& list, const ComparedRun& run, const ComparedRun& other) {
  for (const auto& [figure, name] : EnumNames<FrameFigure>::value) {
    const auto difference = paired_difference(run.errors, other.errors, figure);
    if (!difference) continue;
    list.push_back({{"of", run.name},
                    {"against", other.name},
                    {"figure", name},
                    {"frames", difference->samples},
                    {"mean", difference->mean},
                    {"low", difference->low},
                    {"high", difference->high},
                    {"verdict", difference_verdict(*difference)}});
  }
}

json mean_errors(const ComparedRun& run) {
  json means = json::object();
  for (const auto& [figure, name] : EnumNames<FrameFigure>::value) {
    const auto mean = mean_error(run.errors, figure);
    means[std::string(name)] = mean ? json(*mean) : json(nullptr);
  }
  return means;
}

json estimator_json(const ComparedRun& run) {
  json result = run.summary;
  for (const char* of_all : {"memory", "interrupted", "source_complaint"}) result.erase(of_all);
  const json& frames = run.summary["frames"];
  const auto read = frames["read"].get<double>();
  result["name"] = run.name;
  result["policy"] = name_of(run.estimator.policy);
  result["mode"] = name_of(run.estimator.mode_in_use());
  result["keys"] = run.overrides;
  result["availability_ratio"] =
      read > 0 ? json(frames["used"].get<double>() / read) : json(nullptr);
  result["timing"]["total_s"] = run.estimator_s;
  result["mean_error"] = mean_errors(run);
  return result;
}

}  // namespace

json comparison_json(std::span<const ComparedRun> runs, const ComparisonFacts& facts) {
  json estimators = json::array();
  json differences = json::array();
  json estimator_s = json::object();
  for (std::size_t i = 0; i < runs.size(); ++i) {
    estimators.push_back(estimator_json(runs[i]));
    estimator_s[runs[i].name] = runs[i].estimator_s;
    for (std::size_t before = 0; before < i; ++before) {
      add_differences(differences, runs[i], runs[before]);
    }
  }
  return {{"estimators", std::move(estimators)},
          {"differences", std::move(differences)},
          {"frames_read", facts.frames_read},
          {"timing",
           {{"wall_s", facts.wall_s},
            {"decoding_s", facts.decoding_s},
            {"estimators_s", std::move(estimator_s)},
            {"threads", facts.threads}}},
          {"interrupted", facts.interrupted},
          {"source_complaint", facts.problem ? json(*facts.problem) : json(nullptr)}};
}

std::string_view difference_verdict(const MeanInterval& difference) {
  if (!difference.is_reliable) return "drifting";
  if (!differs_from_zero(difference)) return "not_significant";
  return difference.mean < 0 ? "better" : "worse";
}

}  // namespace stillkite
