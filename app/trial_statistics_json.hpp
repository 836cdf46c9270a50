#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "simulation/hover/hover_trial.hpp"

namespace stillkite {

/// {mean_UNIT, std_UNIT, max_UNIT} of signed values; null without values.
[[nodiscard]] nlohmann::json statistics_json(const std::vector<double>& values,
                                             const std::string& unit);

/// These statistics over all samples of the flights with or without stabilization, along x, y, z
/// and all axes; `values_of` returns the values of a flight.
[[nodiscard]] nlohmann::json statistics_by_axis(
    std::span<const TrialRecord> records, bool stabilized, const std::string& unit,
    const std::function<std::vector<double>(const TrialRecord&)>& values_of);

}  // namespace stillkite
