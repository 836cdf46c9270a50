#include "app/trial_statistics_json.hpp"

#include <nlohmann/json.hpp>
#include <optional>

#include "evaluation/trial_statistics.hpp"

namespace stillkite {

using nlohmann::json;

json statistics_json(const std::vector<double>& values, const std::string& unit) {
  const std::optional<SignedStatistics> found = signed_statistics(values);
  const auto figure = [&](double SignedStatistics::*member) {
    return found ? json((*found).*member) : json(nullptr);
  };
  return {{"mean_" + unit, figure(&SignedStatistics::mean)},
          {"std_" + unit, figure(&SignedStatistics::deviation)},
          {"max_" + unit, figure(&SignedStatistics::max)}};
}

json statistics_by_axis(std::span<const TrialRecord> records, bool stabilized,
                        const std::string& unit,
                        const std::function<std::vector<double>(const TrialRecord&)>& values_of) {
  const auto pooled = [&](std::optional<PaperAxis> axis) {
    std::vector<double> all;
    for (const TrialRecord& record : records) {
      if (record.trial.stabilized != stabilized || (axis && record.trial.axis != *axis)) continue;
      const std::vector<double> values = values_of(record);
      all.insert(all.end(), values.begin(), values.end());
    }
    return statistics_json(all, unit);
  };
  json row;
  for (const auto& [axis, name] : EnumNames<PaperAxis>::value) {
    row[std::string(name)] = pooled(axis);
  }
  row["all"] = pooled(std::nullopt);
  return row;
}

}  // namespace stillkite
