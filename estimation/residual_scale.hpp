#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "geometry/median.hpp"

namespace stillkite {

/// Robust standard deviation of inliers: `sigma_of_median` times the median of the distances below
/// `threshold`. Returns 0 without inliers.
///
/// `sigma_of_median`: 1.4826 for distances of one component, 0.8493 for those of two.
[[nodiscard]] inline double inlier_scale(const std::vector<float>& distances, double threshold,
                                         double sigma_of_median) {
  std::vector<float> inliers;
  inliers.reserve(distances.size());
  for (const float d : distances) {
    if (d < threshold) inliers.push_back(d);
  }
  if (inliers.empty()) return 0;
  return sigma_of_median * static_cast<double>(upper_median(inliers));
}

}  // namespace stillkite
