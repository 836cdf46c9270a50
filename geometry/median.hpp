#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace stillkite {

/// Of an even number the upper one of the middle two. Reorders the values, of which there is at
/// least one.
template <typename T>
[[nodiscard]] T upper_median(std::vector<T>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Of an even number the mean of the middle two. Of at least one value.
[[nodiscard]] inline double median(std::vector<double> values) {
  const double upper = upper_median(values);
  if (values.size() % 2 == 1) return upper;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  return 0.5 * (upper + *std::max_element(values.begin(), middle));
}

}  // namespace stillkite
