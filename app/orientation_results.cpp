#include "app/orientation_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "app/trial_statistics_json.hpp"
#include "evaluation/yaw_settling.hpp"
#include "geometry/angle.hpp"

namespace stillkite {
namespace {

using nlohmann::json;

constexpr double kSettled_deg = 3;
constexpr double kSettlingLimit_s = 5;

std::vector<double> yaw_deg(const TrialRecord& record) {
  std::vector<double> values;
  values.reserve(record.samples.size());
  for (const TrialSample& sample : record.samples) values.push_back(sample.yaw_rad / kDegree);
  return values;
}

std::vector<std::optional<double>> settling_times_s(const TrialRecord& record) {
  std::vector<double> t_s;
  std::vector<double> yaw_rad;
  for (const TrialSample& sample : record.samples) {
    t_s.push_back(sample.t_s);
    yaw_rad.push_back(sample.yaw_rad);
  }
  std::vector<std::optional<double>> times_s;
  for (std::size_t i = 0; i < record.kicks.size(); ++i) {
    const double next_s =
        i + 1 < record.kicks.size() ? record.kicks[i + 1].at_s : std::numeric_limits<double>::max();
    times_s.push_back(
        settling_time_s({t_s, yaw_rad}, record.kicks[i].at_s, next_s, kSettled_deg * kDegree));
  }
  return times_s;
}

json kick_json(std::size_t trial, const YawKick& kick, const std::optional<double>& settled_s) {
  return {{"trial", trial},
          {"kind", kick.duration_s > 0 ? "gust" : "step"},
          {"at_s", kick.at_s},
          {"duration_s", kick.duration_s},
          {"angle_deg", kick.angle_rad / kDegree},
          {"settled_s", settled_s ? json(*settled_s) : json(nullptr)}};
}

// A kick that never settles counts as infinite.
json settled_json(const std::vector<std::optional<double>>& times_s) {
  std::vector<double> sorted;
  sorted.reserve(times_s.size());
  for (const auto& time_s : times_s) {
    sorted.push_back(time_s.value_or(std::numeric_limits<double>::infinity()));
  }
  std::sort(sorted.begin(), sorted.end());
  const auto finite = [](double value) {
    return std::isfinite(value) ? json(value) : json(nullptr);
  };
  const auto within_limit = std::count_if(sorted.begin(), sorted.end(),
                                          [](double time_s) { return time_s <= kSettlingLimit_s; });
  return {{"kicks", sorted.size()},
          {"within_5_s", within_limit},
          {"median_s", sorted.empty() ? json(nullptr) : finite(sorted[(sorted.size() - 1) / 2])},
          {"worst_s", sorted.empty() ? json(nullptr) : finite(sorted.back())}};
}

std::string figure_or_dash(const json& value) {
  return value.is_number() ? fmt::format("{:.2f}", value.get<double>()) : "-";
}

}  // namespace

json orientation_summary(std::span<const TrialRecord> records) {
  const bool is_kicked = std::any_of(records.begin(), records.end(),
                                     [](const TrialRecord& r) { return !r.kicks.empty(); });
  if (!is_kicked) return nullptr;
  json kicks = json::array();
  std::vector<std::optional<double>> all_s;
  for (std::size_t trial = 0; trial < records.size(); ++trial) {
    const TrialRecord& record = records[trial];
    if (!record.trial.stabilized) continue;
    const std::vector<std::optional<double>> times_s = settling_times_s(record);
    for (std::size_t i = 0; i < times_s.size(); ++i) {
      kicks.push_back(kick_json(trial, record.kicks[i], times_s[i]));
    }
    all_s.insert(all_s.end(), times_s.begin(), times_s.end());
  }
  const auto yaw_by_axis = [&](bool stabilized) {
    return statistics_by_axis(records, stabilized, "deg", yaw_deg);
  };
  return {{"limit_deg", kSettled_deg},
          {"settling", settled_json(all_s)},
          {"kicks", std::move(kicks)},
          {"table", {{"on", yaw_by_axis(true)}, {"off", yaw_by_axis(false)}}}};
}

std::string orientation_table(const json& orientation) {
  if (orientation.is_null()) return "";
  std::string out =
      fmt::format("\n{:<28}{:>16}{:>16}{:>16}{:>16}\n", "yaw, degrees", "x", "y", "z", "all");
  for (const char* trials : {"on", "off"}) {
    for (const char* figure : {"mean_deg", "std_deg", "max_deg"}) {
      out += fmt::format("stabilization {:<4}{:<10}", trials, figure);
      for (const char* axis : {"x", "y", "z", "all"}) {
        out += fmt::format("{:>16}", figure_or_dash(orientation["table"][trials][axis][figure]));
      }
      out += '\n';
    }
  }
  const json& settling = orientation["settling"];
  return out + fmt::format(
                   "{} kicks, settling time to {} degrees {} s (median), {} s (worst); {} "
                   "within {} s\n",
                   settling["kicks"].dump(), kSettled_deg, figure_or_dash(settling["median_s"]),
                   figure_or_dash(settling["worst_s"]), settling["within_5_s"].dump(),
                   kSettlingLimit_s);
}

}  // namespace stillkite
