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

/// Displacement d along a trial's moved axis: the figures of the hold paper's Table I.
struct DisplacementStatistics {
  int samples = 0;
  double mean_m = 0;  ///< of |d|
  double std_m = 0;   ///< of signed d
  double max_m = 0;   ///< of |d|
};

/// Nothing of no samples.
[[nodiscard]] std::optional<DisplacementStatistics> displacement_statistics(
    std::span<const double> displacements_m);

}  // namespace stillkite
