#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace stillkite {

/// The main figures of comparison.json for a person, a column an estimator. Errors say whether they
/// are significantly better or worse than those of the first.
[[nodiscard]] std::string comparison_table(const nlohmann::json& comparison);

}  // namespace stillkite
