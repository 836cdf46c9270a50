#pragma once

#include <string>

#include "navigation/navigation_estimate.hpp"

namespace stillkite {

/// The first line of estimates.csv: names with units, and its end of line.
[[nodiscard]] std::string estimates_csv_header();

/// One frame's line. Cells of what was not measured are empty. Euler angles are ZYX of the body.
[[nodiscard]] std::string estimates_csv_row(const NavigationEstimate& estimate);

}  // namespace stillkite
