#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace stillkite {

/// Standard deviation by the median of the distances below a threshold; 0 where there are none.
/// `sigma_of_median`: 1.4826 for the distance of one component, 0.8493 for that of two.
[[nodiscard]] inline double scale_below(const std::vector<float>& distances, double threshold,
                                        double sigma_of_median) {
  std::vector<float> below;
  below.reserve(distances.size());
  for (const float d : distances) {
    if (d < threshold) below.push_back(d);
  }
  if (below.empty()) return 0;
  const auto middle = below.begin() + static_cast<std::ptrdiff_t>(below.size() / 2);
  std::nth_element(below.begin(), middle, below.end());
  return sigma_of_median * static_cast<double>(*middle);
}

}  // namespace stillkite
