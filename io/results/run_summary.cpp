#include "io/results/run_summary.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "geometry/euler.hpp"

namespace stillkite {
namespace {

using nlohmann::json;

json number(double value) {
  return std::isfinite(value) ? json(value) : json(nullptr);
}

json numbers(const auto& values) {
  json list = json::array();
  for (const double value : values) list.push_back(number(value));
  return list;
}

// Nearest-rank quantile; null without values.
json quantile(std::vector<float> values, double ratio) {
  if (values.empty()) return nullptr;
  const auto rank =
      static_cast<std::ptrdiff_t>(std::ceil(ratio * static_cast<double>(values.size())) - 1);
  const auto at = values.begin() + std::max<std::ptrdiff_t>(0, rank);
  std::nth_element(values.begin(), at, values.end());
  return number(*at);
}

json verdict_counts(const RunTally& tally) {
  json counts = json::object();
  for (const auto& [verdict, name] : EnumNames<Verdict>::value) {
    counts[std::string(name)] = tally.verdicts.at(static_cast<std::size_t>(verdict));
  }
  return counts;
}

json stage_medians(const RunTally& tally) {
  json medians = json::object();
  for (const auto& [stage, name] : EnumNames<Stage>::value) {
    medians[std::string(name)] = quantile(tally.stage_ms.at(static_cast<std::size_t>(stage)), 0.5);
  }
  return medians;
}

std::int64_t used_frames(const RunTally& tally) {
  std::int64_t used = 0;
  for (const auto& [verdict, name] : EnumNames<Verdict>::value) {
    if (is_measured(verdict)) used += tally.verdicts.at(static_cast<std::size_t>(verdict));
  }
  return used;
}

json ratio(std::int64_t part, std::int64_t all) {
  return all > 0 ? json(static_cast<double>(part) / static_cast<double>(all)) : json(nullptr);
}

json final_state(const NavigationEstimate& e) {
  const EulerAngles angles = to_euler(e.world_from_body.rotation);
  const Eigen::Quaterniond& q = e.world_from_body.rotation;
  const json position = numbers(e.world_from_body.translation);
  const json velocity = numbers(e.velocity_in_world_m_s);
  const bool is_metric = e.scale != ScaleSource::none;
  return {{"t_s", number(to_seconds(e.stamp))},
          {"verdict", name_of(e.verdict)},
          {"position_m", is_metric ? position : json()},
          {"position_in_heights", is_in_heights(e) ? position : json()},
          {"quaternion_wxyz", numbers(std::array{q.w(), q.x(), q.y(), q.z()})},
          {"yaw_rad", number(angles.yaw_rad)},
          {"pitch_rad", number(angles.pitch_rad)},
          {"roll_rad", number(angles.roll_rad)},
          {"velocity_in_world_m_s", is_metric ? velocity : json()},
          {"velocity_in_world_in_heights_s", is_in_heights(e) ? velocity : json()}};
}

json command_counts(const std::optional<CommandCounts>& counts) {
  if (!counts) return nullptr;
  return {{"issued", counts->issued}, {"held", counts->held}};
}

}  // namespace

void RunTally::add(const NavigationEstimate& estimate) {
  ++frames;
  ++verdicts.at(static_cast<std::size_t>(estimate.verdict));
  for (std::size_t i = 0; i < stage_ms.size(); ++i) {
    stage_ms[i].push_back(static_cast<float>(estimate.stage_ms[i]));
  }
  if (!first_stamp) first_stamp = estimate.stamp;
  last = estimate;
  max_masked_ratio = std::max(max_masked_ratio, estimate.masked_ratio);
}

json run_summary(const RunTally& tally, const RunFacts& facts, json evaluation) {
  const std::vector<float> frame_ms(facts.frame_ms.begin(), facts.frame_ms.end());
  const NavigationEstimate* last = tally.last ? &*tally.last : nullptr;
  const std::int64_t used = used_frames(tally);
  const double frames_per_s = static_cast<double>(tally.frames) / facts.wall_s;
  return {
      {"frames",
       {{"read", facts.frames_read}, {"used", used}, {"rejected", facts.frames_read - used}}},
      {"availability_ratio", ratio(used, facts.frames_read)},
      {"verdicts", verdict_counts(tally)},
      {"timing",
       {{"frame_ms", {{"median", quantile(frame_ms, 0.5)}, {"p99", quantile(frame_ms, 0.99)}}},
        {"stages_ms", stage_medians(tally)},
        {"frames_per_s", number(frames_per_s)}}},
      {"memory", {{"peak_rss_mib", number(peak_rss_mib())}}},
      {"final", last == nullptr ? json(nullptr) : final_state(*last)},
      {"scale",
       {{"source", name_of(last == nullptr ? ScaleSource::none : last->scale)},
        {"age_s", last == nullptr ? json(nullptr) : number(last->scale_age_s)},
        {"unit", last == nullptr || last->scale == ScaleSource::none ? "initial_height" : "m"}}},
      {"commands", command_counts(facts.commands)},
      {"interrupted", facts.interrupted},
      {"source_complaint", facts.problem ? json(*facts.problem) : json(nullptr)},
      {"evaluation", std::move(evaluation)},
  };
}

// Not getrusage: its peak includes that of the process that started this one.
double peak_rss_mib() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    double peak_kib = 0;
    if (word == "VmHWM:" && status >> peak_kib) return peak_kib / 1024.0;
  }
  return std::nan("");
}

}  // namespace stillkite
