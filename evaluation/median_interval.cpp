#include "evaluation/median_interval.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

namespace stillkite {
namespace {

std::vector<double> sorted(std::span<const double> samples) {
  std::vector<double> values(samples.begin(), samples.end());
  std::sort(values.begin(), values.end());
  return values;
}

// P(B = k), B ~ Binomial(n, 1/2)
double binomial_probability(int k, int n) {
  return std::exp(std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0) -
                  n * std::numbers::ln2);
}

// Largest j with 2 P(B <= j - 1) <= 5 %; 0: none.
int rank_of_lower_bound(int n) {
  int rank = 0;
  for (double tail = 0; rank < n; ++rank) {
    tail += binomial_probability(rank, n);
    if (2 * tail > 0.05) break;
  }
  return rank;
}

}  // namespace

std::optional<MedianInterval> median_interval(std::span<const double> samples) {
  if (samples.empty()) return std::nullopt;
  const std::vector<double> values = sorted(samples);
  const std::size_t n = values.size();
  MedianInterval result{.samples = static_cast<int>(n),
                        .median = std::midpoint(values[(n - 1) / 2], values[n / 2]),
                        .interval = std::nullopt};
  const auto rank = static_cast<std::size_t>(rank_of_lower_bound(result.samples));
  if (rank > 0) result.interval = {.low = values[rank - 1], .high = values[n - rank]};
  return result;
}

std::optional<double> nearest_rank_quantile(std::span<const double> samples, double ratio) {
  if (samples.empty()) return std::nullopt;
  const double rank = std::ceil(ratio * static_cast<double>(samples.size()));
  return sorted(samples)[static_cast<std::size_t>(std::max(1.0, rank)) - 1];
}

}  // namespace stillkite
