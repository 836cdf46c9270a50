#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

#include "geometry/fields.hpp"

namespace stillkite {

/// Weights w of an M-estimator of the squared length d^2, d the length of a residual of two
/// components in units of its standard deviation. The tuning constants keep 95 % of the efficiency
/// on Gaussian noise.
enum class RobustKernel { huber, tukey, geman_mcclure };

template <>
struct EnumNames<RobustKernel> {
  static constexpr auto value = std::to_array<std::pair<RobustKernel, std::string_view>>(
      {{RobustKernel::huber, "huber"},
       {RobustKernel::tukey, "tukey"},
       {RobustKernel::geman_mcclure, "geman_mcclure"}});
};

/// w(d), and the mean derivative of the influence w(d) r over the two components: w + d w' / 2.
struct RobustWeight {
  double weight;
  double slope;
};

[[nodiscard]] inline RobustWeight robust_weight(RobustKernel kernel, double squared_distance) {
  constexpr double kHuber = 1.5;
  constexpr double kTukey = 5.1;
  constexpr double kGemanMcClure = 4.1;
  switch (kernel) {
    case RobustKernel::huber: {
      if (squared_distance <= kHuber * kHuber) return {1, 1};
      const double w = kHuber / std::sqrt(squared_distance);
      return {w, 0.5 * w};
    }
    case RobustKernel::tukey: {
      const double q = squared_distance / (kTukey * kTukey);
      if (q >= 1) return {0, 0};
      return {(1 - q) * (1 - q), (1 - q) * (1 - 3 * q)};
    }
    case RobustKernel::geman_mcclure: {
      const double q = 1 + squared_distance / (kGemanMcClure * kGemanMcClure);
      return {1 / (q * q), (2 - q) / (q * q * q)};
    }
  }
  return {1, 1};
}

/// Median length of two standard normal components, sqrt(2 ln 2).
inline constexpr double kRayleighMedian = 1.1774100225154747;

}  // namespace stillkite
