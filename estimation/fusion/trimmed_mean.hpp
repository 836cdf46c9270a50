#pragma once

#include <cmath>

namespace stillkite {

/// Of errors of two components the share that is furthest from their mean is left out. By how much
/// the variance of the mean of the rest exceeds that of as many errors of which none was left out:
/// those that stay agree better than they are known. `share` in [0, 1); of many normal errors.
/// (Huber, Robust Statistics, 1981, section 3.3; their squares are exponentially distributed.)
[[nodiscard]] inline double trimmed_mean_growth(double share) {
  if (share <= 0) return 1;
  const double kept = 1 - share;
  return kept / (kept + share * std::log(share));
}

}  // namespace stillkite
