#include "io/results/run_summary.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

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

json verdict_counts(std::span<const NavigationEstimate> estimates) {
  json counts = json::object();
  for (const auto& [verdict, name] : EnumNames<Verdict>::value) counts[std::string(name)] = 0;
  for (const NavigationEstimate& e : estimates) {
    json& count = counts[std::string(name_of(e.verdict))];
    count = count.get<std::int64_t>() + 1;
  }
  return counts;
}

json stage_medians(std::span<const NavigationEstimate> estimates) {
  json medians = json::object();
  for (const auto& [stage, name] : EnumNames<Stage>::value) {
    std::vector<float> values;
    for (const NavigationEstimate& e : estimates) {
      values.push_back(static_cast<float>(e.stage_ms[static_cast<std::size_t>(stage)]));
    }
    medians[std::string(name)] = quantile(std::move(values), 0.5);
  }
  return medians;
}

json final_state(const NavigationEstimate& e) {
  const EulerAngles angles = to_euler(e.world_from_body.rotation);
  const Eigen::Quaterniond& q = e.world_from_body.rotation;
  return {{"t_s", number(to_seconds(e.stamp))},
          {"verdict", name_of(e.verdict)},
          {"position_m", numbers(e.world_from_body.translation)},
          {"quaternion_wxyz", numbers(std::array{q.w(), q.x(), q.y(), q.z()})},
          {"yaw_rad", number(angles.yaw_rad)},
          {"pitch_rad", number(angles.pitch_rad)},
          {"roll_rad", number(angles.roll_rad)},
          {"velocity_in_world_m_s", numbers(e.velocity_in_world_m_s)}};
}

json command_counts(const std::optional<CommandCounts>& counts) {
  if (!counts) return nullptr;
  return {{"issued", counts->issued}, {"held", counts->held}};
}

}  // namespace

json run_summary(std::span<const NavigationEstimate> estimates, const RunFacts& facts,
                 json evaluation) {
  const std::vector<float> frame_ms(facts.frame_ms.begin(), facts.frame_ms.end());
  const NavigationEstimate* last = estimates.empty() ? nullptr : &estimates.back();
  const std::int64_t used =
      std::count_if(estimates.begin(), estimates.end(),
                    [](const NavigationEstimate& e) { return is_measured(e.verdict); });
  const double frames_per_s = static_cast<double>(estimates.size()) / facts.wall_s;
  return {
      {"frames",
       {{"read", facts.frames_read}, {"used", used}, {"rejected", facts.frames_read - used}}},
      {"verdicts", verdict_counts(estimates)},
      {"timing",
       {{"frame_ms", {{"median", quantile(frame_ms, 0.5)}, {"p99", quantile(frame_ms, 0.99)}}},
        {"stages_ms", stage_medians(estimates)},
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

double peak_rss_mib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

}  // namespace stillkite
