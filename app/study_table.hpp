#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace stillkite {

/// Statistics of study.json as a text: per metric one row per group.
[[nodiscard]] std::string study_table(const nlohmann::json& study);

/// Metrics that no result of study.json contains, each with the nearest known figure.
[[nodiscard]] std::vector<std::string> unknown_metrics(const nlohmann::json& study);

}  // namespace stillkite
