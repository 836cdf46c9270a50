#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace stillkite {

/// Median; of an even count the upper of the two middle values. Reorders `values`, not empty.
template <typename T>
[[nodiscard]] T upper_median(std::vector<T>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Median; of an even count the mean of the two middle values. `values`: not empty.
[[nodiscard]] inline double median(std::vector<double> values) {
  const double upper = upper_median(values);
  if (values.size() % 2 == 1) return upper;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  return 0.5 * (upper + *std::max_element(values.begin(), middle));
}

}  // namespace stillkite
