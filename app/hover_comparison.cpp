#include "app/hover_comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "app/comparison_results.hpp"
#include "app/hover_results.hpp"
#include "evaluation/trial_statistics.hpp"

namespace stillkite {
namespace {

using nlohmann::json;

constexpr std::array<std::pair<const char*, std::optional<PaperAxis>>, 4> kComparedAxes{
    {{"x", PaperAxis::x}, {"y", PaperAxis::y}, {"z", PaperAxis::z}, {"all", std::nullopt}}};

bool is_compared(const TrialRecord& record, std::optional<PaperAxis> axis) {
  return record.trial.stabilized && (!axis || record.trial.axis == *axis);
}

std::optional<double> mean_displacement_m(const TrialRecord& record) {
  const auto found = signed_statistics(displacements_m(record));
  return found ? std::optional(found->mean) : std::nullopt;
}

std::vector<double> trial_means_m(const ComparedTrials& flown, std::optional<PaperAxis> axis) {
  std::vector<double> means;
  means.reserve(flown.records.size());
  for (const TrialRecord& record : flown.records) {
    if (!is_compared(record, axis)) continue;
    if (const auto mean_m = mean_displacement_m(record)) means.push_back(*mean_m);
  }
  return means;
}

// Differences between trials with the same axis and seed.
std::vector<double> trial_differences_m(const ComparedTrials& flown, const ComparedTrials& other,
                                        std::optional<PaperAxis> axis) {
  std::vector<double> differences;
  differences.reserve(flown.records.size());
  for (const TrialRecord& record : flown.records) {
    if (!is_compared(record, axis)) continue;
    const auto match =
        std::find_if(other.records.begin(), other.records.end(), [&](const TrialRecord& candidate) {
          return is_compared(candidate, record.trial.axis) &&
                 candidate.trial.seed == record.trial.seed;
        });
    if (match == other.records.end()) continue;
    const auto mean_m = mean_displacement_m(record);
    const auto other_mean_m = mean_displacement_m(*match);
    if (mean_m && other_mean_m) differences.push_back(*mean_m - *other_mean_m);
  }
  return differences;
}

json interval_json(const std::vector<double>& samples) {
  const auto interval = independent_mean_interval(samples);
  json result{
      {"trials", samples.size()}, {"mean_m", nullptr}, {"low_m", nullptr}, {"high_m", nullptr}};
  if (samples.size() == 1) result["mean_m"] = samples.front();
  if (!interval) return result;
  result["mean_m"] = interval->mean;
  result["low_m"] = interval->low;
  result["high_m"] = interval->high;
  return result;
}

void add_trial_differences(json& list, const ComparedTrials& flown, const ComparedTrials& other) {
  for (const auto& [name, axis] : kComparedAxes) {
    const std::vector<double> samples = trial_differences_m(flown, other, axis);
    json difference = interval_json(samples);
    const auto interval = independent_mean_interval(samples);
    difference["of"] = flown.name;
    difference["against"] = other.name;
    difference["axis"] = name;
    difference["verdict"] = interval ? json(difference_verdict(*interval)) : json(nullptr);
    list.push_back(std::move(difference));
  }
}

std::string centimetre_text(const json& interval) {
  if (!interval["mean_m"].is_number()) return "-";
  const double mean_m = interval["mean_m"].get<double>();
  if (!interval["high_m"].is_number()) return fmt::format("{:.2f}", 100 * mean_m);
  return fmt::format("{:.2f} +- {:.2f}", 100 * mean_m,
                     100 * (interval["high_m"].get<double>() - mean_m));
}

std::string verdict_against_first(const json& comparison, const json& entry, const char* axis) {
  for (const json& difference : comparison["differences"]) {
    if (difference["of"] != entry["name"] || difference["axis"] != axis) continue;
    if (difference["against"] != comparison["estimators"][0]["name"]) continue;
    if (!difference["verdict"].is_string()) return "";
    const auto verdict = difference["verdict"].get<std::string>();
    return verdict == "not_significant" ? "n.s." : verdict;
  }
  return "";
}

}  // namespace

json hover_comparison_json(std::span<const ComparedTrials> estimators) {
  json entries = json::array();
  json differences = json::array();
  for (std::size_t i = 0; i < estimators.size(); ++i) {
    const ComparedTrials& flown = estimators[i];
    json displacement = json::object();
    for (const auto& [name, axis] : kComparedAxes) {
      displacement[name] = interval_json(trial_means_m(flown, axis));
    }
    entries.push_back({{"name", flown.name},
                       {"policy", name_of(flown.estimator.policy)},
                       {"mode", name_of(flown.estimator.mode_in_use())},
                       {"keys", flown.overrides},
                       {"displacement", std::move(displacement)},
                       {"table", flown.summary["table"]},
                       {"timing", flown.summary["timing"]}});
    for (std::size_t before = 0; before < i; ++before) {
      add_trial_differences(differences, flown, estimators[before]);
    }
  }
  return {{"estimators", std::move(entries)}, {"differences", std::move(differences)}};
}

std::string hover_comparison_table(const json& comparison) {
  std::string text = fmt::format("{:<30}", "mean |d| per trial, cm");
  for (const json& entry : comparison["estimators"]) {
    text += fmt::format("{:>18}{:9}", entry["name"].get<std::string>(), "");
  }
  for (const auto& [name, axis] : kComparedAxes) {
    text.erase(text.find_last_not_of(' ') + 1);
    text += fmt::format(
        "\n{:<30}",
        fmt::format("{} ({} trials)", name,
                    comparison["estimators"][0]["displacement"][name]["trials"].dump()));
    for (const json& entry : comparison["estimators"]) {
      text += fmt::format("{:>18} {:<8}", centimetre_text(entry["displacement"][name]),
                          verdict_against_first(comparison, entry, name));
    }
  }
  text.erase(text.find_last_not_of(' ') + 1);
  return text + fmt::format(
                    "\n+-: 95 % interval of the mean over trials (Student's t); better, worse: "
                    "significant difference from {} on the same seeds; n.s.: not significant\n",
                    comparison["estimators"][0]["name"].get<std::string>());
}

}  // namespace stillkite
