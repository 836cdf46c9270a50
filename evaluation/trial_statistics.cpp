#include "evaluation/trial_statistics.hpp"

#include <algorithm>
#include <cmath>

namespace stillkite {

std::optional<SignedStatistics> signed_statistics(std::span<const double> values) {
  if (values.empty()) return std::nullopt;
  const double n = static_cast<double>(values.size());
  SignedStatistics result{.samples = static_cast<int>(values.size())};
  double sum = 0;
  double squares = 0;
  for (const double value : values) {
    result.mean += std::abs(value) / n;
    result.max = std::max(result.max, std::abs(value));
    sum += value;
  }
  for (const double value : values) squares += (value - sum / n) * (value - sum / n);
  result.deviation = std::sqrt(squares / n);
  return result;
}

}  // namespace stillkite
