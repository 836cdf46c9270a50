#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/study.hpp"

namespace stillkite {

/// Value of a figure of a row of study.json; nullopt if unknown or not finite.
[[nodiscard]] std::optional<double> figure_value(const nlohmann::json& row,
                                                 const std::string& figure);

/// Groups of study.json: rows with the same group of flights, configuration and estimator; if no
/// group of flights has two of them, rows with the same configuration and estimator. Per metric:
/// number of samples, median with its 95 % interval, the value than which nine in ten are not
/// worse, worst value and its job.
[[nodiscard]] nlohmann::json study_groups(const std::vector<nlohmann::json>& rows,
                                          const std::vector<StudyMetric>& metrics);

}  // namespace stillkite
