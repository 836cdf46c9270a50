#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace stillkite {

/// Estimate with its standard deviation.
struct BlockEstimate {
  double value = 0;
  double sigma = 0;

  /// Distance from a value, in standard deviations.
  [[nodiscard]] double sigmas_from(double other) const {
    return sigma > 0 ? std::abs(value - other) / sigma : 0;
  }
};

/// Number of blocks of a sample: consecutive values are correlated, blocks nearly are not.
inline constexpr std::size_t kBlocks = 10;

/// Delete-one-block jackknife (Kuensch, Annals of Statistics 17(3), 1989) of a statistic over
/// `count` consecutive samples, at least kBlocks. `statistic(excluded)` returns its value without
/// the samples for whose index `excluded` is true.
template <typename Statistic>
[[nodiscard]] BlockEstimate block_jackknife(std::size_t count, const Statistic& statistic) {
  const double whole = statistic([](std::size_t) { return false; });
  std::vector<double> partial;
  double mean = 0;
  for (std::size_t block = 0; block < kBlocks; ++block) {
    const std::size_t first = block * count / kBlocks, last = (block + 1) * count / kBlocks;
    partial.push_back(statistic([=](std::size_t i) { return i >= first && i < last; }));
    mean += partial.back() / kBlocks;
  }
  double sum = 0;
  for (const double value : partial) sum += (value - mean) * (value - mean);
  return {whole, std::sqrt(sum * (kBlocks - 1) / kBlocks)};
}

}  // namespace stillkite
