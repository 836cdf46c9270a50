#pragma once

#include <optional>
#include <span>

namespace stillkite {

/// The figures of the hold paper's Table I, of any signed quantity and in its unit.
struct SignedStatistics {
  int samples = 0;
  double mean = 0;       ///< of the absolute value
  double deviation = 0;  ///< standard, of the signed value
  double max = 0;        ///< of the absolute value
};

/// Nothing of no samples.
[[nodiscard]] std::optional<SignedStatistics> signed_statistics(std::span<const double> values);

}  // namespace stillkite
