#pragma once

#include <optional>
#include <span>

namespace stillkite {

/// Median and its two-sided confidence interval of at least 95 %, in the unit of the samples.
struct MedianInterval {
  struct Bounds {
    double low = 0;
    double high = 0;
  };

  int samples = 0;
  double median = 0;
  std::optional<Bounds> interval;  ///< std::nullopt below 6 samples: no interval has 95 %
};

/// Order-statistic interval of independent samples, such as trials of several seeds, without an
/// assumption about their distribution: with B ~ Binomial(n, 1/2),
///
///     P(x_(j) <= median <= x_(n+1-j)) >= 1 - 2 P(B <= j - 1),   the largest j with >= 0.95
///
/// (David & Nagaraja, Order Statistics, 2003, section 7.1). std::nullopt without samples.
[[nodiscard]] std::optional<MedianInterval> median_interval(std::span<const double> samples);

/// Nearest-rank quantile: the smallest sample that at least `ratio` of the samples do not exceed.
/// std::nullopt without samples. 0 < ratio <= 1.
[[nodiscard]] std::optional<double> nearest_rank_quantile(std::span<const double> samples,
                                                          double ratio);

}  // namespace stillkite
