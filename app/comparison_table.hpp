#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace stillkite {

/// Text table of the main figures of comparison.json, one column per estimator. Errors are marked
/// if they differ significantly from the first estimator's.
[[nodiscard]] std::string comparison_table(const nlohmann::json& comparison);

}  // namespace stillkite
