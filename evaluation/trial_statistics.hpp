#pragma once

#include <optional>
#include <span>

namespace stillkite {

/// Statistics of the hold paper's Table I for a signed quantity, in its unit.
struct SignedStatistics {
  int samples = 0;
  double mean = 0;       ///< mean absolute value
  double deviation = 0;  ///< standard deviation of the signed value
  double max = 0;        ///< maximum absolute value
};

/// std::nullopt without samples.
[[nodiscard]] std::optional<SignedStatistics> signed_statistics(std::span<const double> values);

}  // namespace stillkite
