#pragma once

#include <string>

#include "navigation/navigation_estimate.hpp"

namespace stillkite {

/// Header line of estimates.csv: names with units, newline included.
[[nodiscard]] std::string estimates_csv_header();

/// Row of one frame, newline included. Unknown cells are empty, those in
/// metres without a scale source, too. Euler angles: ZYX, body.
[[nodiscard]] std::string estimates_csv_row(const NavigationEstimate& estimate);

}  // namespace stillkite
