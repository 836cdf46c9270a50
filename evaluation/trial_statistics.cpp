#include "evaluation/trial_statistics.hpp"

#include <algorithm>
#include <cmath>

namespace stillkite {

std::optional<DisplacementStatistics> displacement_statistics(
    std::span<const double> displacements_m) {
  if (displacements_m.empty()) return std::nullopt;
  const double n = static_cast<double>(displacements_m.size());
  DisplacementStatistics result{.samples = static_cast<int>(displacements_m.size())};
  double sum = 0;
  double squares = 0;
  for (const double d : displacements_m) {
    result.mean_m += std::abs(d) / n;
    result.max_m = std::max(result.max_m, std::abs(d));
    sum += d;
  }
  for (const double d : displacements_m) squares += (d - sum / n) * (d - sum / n);
  result.std_m = std::sqrt(squares / n);
  return result;
}

}  // namespace stillkite
