#pragma once

#include <string>

#include "geometry/time.hpp"
#include "stabilization/hold_decision.hpp"

namespace stillkite {

/// Header line of commands.csv: names with units, newline included.
[[nodiscard]] std::string commands_csv_header();

/// Row of the decision for the frame at `stamp`, newline included.
[[nodiscard]] std::string commands_csv_row(Timestamp stamp, const HoldDecision& decision);

}  // namespace stillkite
