#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "geometry/median.hpp"

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
  return sigma_of_median * static_cast<double>(upper_median(below));
}

}  // namespace stillkite
