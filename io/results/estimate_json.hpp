#pragma once

#include <string>

#include "navigation/navigation_estimate.hpp"

namespace stillkite {

/// Version of the keys of estimate_json.
inline constexpr int kEstimateSchema = 1;

/// Estimate as one JSON object on one line, newline included: `schema`, and the columns of
/// estimates.csv without their units. Unknown values are null.
[[nodiscard]] std::string estimate_json(const NavigationEstimate& estimate);

}  // namespace stillkite
