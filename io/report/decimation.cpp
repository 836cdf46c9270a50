#include "io/report/decimation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stillkite {

std::vector<float> keep_extremes(std::span<const float> values, std::size_t max_samples) {
  if (values.size() <= max_samples) return {values.begin(), values.end()};
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  const std::size_t intervals = max_samples / 2;
  std::vector<float> kept;
  kept.reserve(2 * intervals);
  for (std::size_t i = 0; i < intervals; ++i) {
    const std::size_t end = (i + 1) * values.size() / intervals;
    std::size_t low = end;
    std::size_t high = end;
    for (std::size_t j = i * values.size() / intervals; j < end; ++j) {
      if (std::isnan(values[j])) continue;
      if (low == end || values[j] < values[low]) low = j;
      if (high == end || values[j] > values[high]) high = j;
    }
    kept.push_back(low == end ? kNaN : values[std::min(low, high)]);
    kept.push_back(low == end ? kNaN : values[std::max(low, high)]);
  }
  return kept;
}

std::vector<float> keep_every_nth(std::span<const float> values, std::size_t max_samples) {
  if (values.size() <= max_samples) return {values.begin(), values.end()};
  std::vector<float> kept;
  kept.reserve(max_samples);
  for (std::size_t i = 0; i < max_samples; ++i) {
    kept.push_back(values[i * (values.size() - 1) / (max_samples - 1)]);
  }
  return kept;
}

}  // namespace stillkite
