#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

namespace stillkite {

/// Normalized estimation error squared e^T P^-1 e (Bar-Shalom et al., 2001, eq. 5.4.2-1).
/// std::nullopt if P is not positive definite.
[[nodiscard]] std::optional<double> nees(const Eigen::Vector3d& error,
                                         const Eigen::Matrix3d& covariance);

/// Covariance consistency: a consistent covariance has a mean NEES of `degrees_of_freedom`.
struct Consistency {
  int samples = 0;
  int degrees_of_freedom = 0;
  double mean = 0;
  /// Two-sided 95 % interval of the mean for independent samples (runs of different seeds; the
  /// frames of one run are correlated).
  double mean_low = 0;
  double mean_high = 0;
  double share_inside = 0;  ///< share below the 95 % quantile; 0.95 if consistent
};

/// std::nullopt without samples.
[[nodiscard]] std::optional<Consistency> consistency(std::span<const double> nees_samples,
                                                     int degrees_of_freedom);

}  // namespace stillkite
