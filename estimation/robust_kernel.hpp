#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

#include "geometry/fields.hpp"
#include "geometry/median.hpp"

namespace stillkite {

/// M-estimator kernels for a two-component residual of length d, in standard deviations. The tuning
/// constants give 95 % efficiency on Gaussian noise.
enum class RobustKernel { huber, tukey, geman_mcclure };

template <>
struct EnumNames<RobustKernel> {
  static constexpr auto value = std::to_array<std::pair<RobustKernel, std::string_view>>(
      {{RobustKernel::huber, "huber"},
       {RobustKernel::tukey, "tukey"},
       {RobustKernel::geman_mcclure, "geman_mcclure"}});
};

/// Weight w(d) and slope w + d w' / 2, the derivative of the influence w(d) r averaged over the two
/// components.
struct RobustWeight {
  double weight;
  double slope;
};

/// Tuning constant of Huber's kernel.
inline constexpr double kHuber = 1.5;

/// Weight and slope at the squared distance d^2.
[[nodiscard]] inline RobustWeight robust_weight(RobustKernel kernel, double squared_distance) {
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

/// Huber's loss at the squared distance d^2: its derivative is the kernel's weight.
[[nodiscard]] inline double huber_loss(double squared_distance) {
  if (squared_distance <= kHuber * kHuber) return squared_distance;
  return 2 * kHuber * std::sqrt(squared_distance) - kHuber * kHuber;
}

/// Median of the Rayleigh distribution, sqrt(2 ln 2): length of two standard normal components.
inline constexpr double kRayleighMedian = 1.1774100225154747;

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
