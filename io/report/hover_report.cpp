#include "io/report/hover_report.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "io/report/assets.hpp"
#include "io/report/base64.hpp"
#include "io/report/decimation.hpp"
#include "io/report/hover_distribution.hpp"
#include "io/report/report_page.hpp"
#include "io/results/output_file.hpp"

namespace stillkite {
namespace {

using nlohmann::json;

// Bound the page size: budget of 12 trials, shared if there are more.
constexpr std::size_t kTotalChartSamples = 12UL * 1400;
constexpr std::size_t kTotalReplaySamples = 12UL * 600;
constexpr std::size_t kTotalImageBytes = 1'500'000;

constexpr std::array<const char*, 3> kPaperAxes{"x", "y", "z"};

/// (action, reason) -> index in the page's list.
using Decision = std::pair<std::string_view, std::string_view>;
using DecisionIndex = std::map<Decision, int>;

Decision decision_of(const HoverReportSample& sample) {
  return {sample.action, sample.reason};
}

DecisionIndex index_decisions(std::span<const HoverReportTrial> trials) {
  DecisionIndex index;
  for (const HoverReportTrial& trial : trials) {
    for (const HoverReportSample& sample : trial.samples) {
      if (!sample.action.empty()) index.try_emplace(decision_of(sample), 0);
    }
  }
  int next = 0;
  for (auto& [decision, place] : index) place = next++;
  return index;
}

std::size_t samples_per_trial(std::size_t all, std::size_t trials) {
  return std::max<std::size_t>(all / std::max<std::size_t>(trials, 12) / 2 * 2, 50);
}

template <typename Value>
std::vector<float> column(const HoverReportTrial& trial, Value&& value) {
  std::vector<float> values;
  values.reserve(trial.samples.size());
  for (const HoverReportSample& sample : trial.samples) {
    values.push_back(static_cast<float>(value(sample)));
  }
  return values;
}

/// Displacement along the moved axis, decimated with its extremes.
json chart(const HoverReportTrial& trial, std::size_t max_samples) {
  const auto drawn = [&](auto&& value) {
    return base64(keep_extremes(column(trial, value), max_samples));
  };
  return {{"time_s", drawn([](const auto& sample) { return sample.t_s; })},
          {"displacement_m",
           drawn([&](const auto& sample) { return sample.displacement_m(trial.moved_axis); })}};
}

/// All columns of the replay, at fewer samples than the chart.
json replay(const HoverReportTrial& trial, const DecisionIndex& decisions,
            std::size_t max_samples) {
  json result = json::object();
  const auto add = [&](const std::string& name, auto&& value) {
    result[name] = base64(keep_every_nth(column(trial, value), max_samples));
  };
  add("time_s", [](const auto& sample) { return sample.t_s; });
  add("yaw_deg", [](const auto& sample) { return sample.yaw_deg; });
  add("decision", [&](const auto& sample) {
    return sample.action.empty() ? -1 : decisions.at(decision_of(sample));
  });
  for (int axis = 0; axis < 3; ++axis) {
    const std::string name = kPaperAxes.at(axis);
    // paper axes x, y, z = world axes x, z, -y
    const int row = axis == 0 ? 0 : 3 - axis;
    const double sign = axis == 2 ? -1 : 1;
    add("displacement_" + name, [&](const auto& sample) { return sample.displacement_m(axis); });
    add("station_" + name,
        [&](const auto& sample) { return sign * sample.station_in_world_m(row); });
    add("drone_" + name, [&](const auto& sample) { return sign * sample.drone_in_world_m(row); });
  }
  return result;
}

/// Decimation factor of the images, from their total size.
std::size_t image_step(std::span<const HoverReportTrial> trials) {
  std::size_t bytes = 0;
  for (const HoverReportTrial& trial : trials) {
    for (const HoverImage& image : trial.images) bytes += image.jpeg.size();
  }
  return 1 + bytes / kTotalImageBytes;
}

/// Images of this trial among every step-th image of all trials.
json images(const HoverReportTrial& trial, std::size_t images_before, std::size_t step) {
  json result = json::array();
  for (std::size_t i = 0; i < trial.images.size(); ++i) {
    if ((images_before + i) % step != 0) continue;
    result.push_back({trial.images[i].t_s, base64(trial.images[i].jpeg)});
  }
  return result;
}

json trial_data(const HoverReportTrial& trial, const DecisionIndex& decisions, std::size_t trials) {
  return {{"axis", kPaperAxes.at(static_cast<std::size_t>(trial.moved_axis))},
          {"stabilized", trial.stabilized},
          {"policy", trial.policy},
          {"seed", trial.seed},
          {"chart", chart(trial, samples_per_trial(kTotalChartSamples, trials))},
          {"replay", replay(trial, decisions, samples_per_trial(kTotalReplaySamples, trials))}};
}

json cells(const std::map<int, int>& counts) {
  json result = json::array();
  for (const auto& [cell, count] : counts) result.push_back({cell, count});
  return result;
}

json cells(const std::map<std::array<int, 2>, int>& counts) {
  json result = json::array();
  for (const auto& [cell, count] : counts) result.push_back({cell[0], cell[1], count});
  return result;
}

template <typename Counts>
json distribution(const Counts& counts) {
  return {{"size_m", counts.size_m}, {"on", cells(counts.on)}, {"off", cells(counts.off)}};
}

/// Number of samples of each decision.
json decision_counts(std::span<const HoverReportTrial> trials, const DecisionIndex& decisions,
                     int moved_axis) {
  std::vector<int> counts(decisions.size());
  for (const HoverReportTrial& trial : trials) {
    if (trial.moved_axis != moved_axis) continue;
    for (const HoverReportSample& sample : trial.samples) {
      if (!sample.action.empty()) ++counts[decisions.at(decision_of(sample))];
    }
  }
  return counts;
}

json hover_data(const HoverReportContent& content, const json& summary) {
  const DecisionIndex decisions = index_decisions(content.trials);
  const std::size_t step = image_step(content.trials);
  std::size_t images_before = 0;
  json trials = json::array();
  for (const HoverReportTrial& trial : content.trials) {
    json data = trial_data(trial, decisions, content.trials.size());
    data["images"] = images(trial, images_before, step);
    images_before += trial.images.size();
    trials.push_back(std::move(data));
  }
  json sets = json::object();
  for (int axis = 0; axis < 3; ++axis) {
    sets[kPaperAxes.at(axis)] = {
        {"across", kPaperAxes.at(axis_across(axis))},
        {"histogram", distribution(displacement_histogram(content.trials, axis))},
        {"heat", distribution(displacement_heat(content.trials, axis))},
        {"decisions", decision_counts(content.trials, decisions, axis)}};
  }
  json names = json::array();
  for (const auto& [decision, place] : decisions)
    names.push_back({decision.first, decision.second});
  return {{"trials", trials}, {"sets", sets}, {"decisions", names}, {"summary", summary}};
}

}  // namespace

std::string hover_report_html(const HoverReportContent& content, const json& summary) {
  return report_page(
      {.brand = "Stillkite hover report",
       .main = report_assets::kHoverMain,
       .style = report_assets::kHoverStyle,
       .script = report_assets::kHoverScript,
       .reset = "Show whole trials",
       .footer = "Drag across a chart to zoom it, shift-drag to pan, double-click to "
                 "reset; on a touch screen use two fingers.",
       .title = content.title,
       .config_yaml = content.config_yaml},
      hover_data(content, summary));
}

void write_hover_report(const std::filesystem::path& path, const HoverReportContent& content,
                        const json& summary) {
  write_file(path, hover_report_html(content, summary));
}

}  // namespace stillkite
