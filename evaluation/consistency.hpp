#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

namespace stillkite {

/// e^T P^-1 e, the normalised estimation error squared (Bar-Shalom et al., 2001, eq. 5.4.2-1);
/// nothing where P is not positive definite (a state that is known exactly).
[[nodiscard]] std::optional<double> nees(const Eigen::Vector3d& error,
                                         const Eigen::Matrix3d& covariance);

/// Whether a covariance is honest: the mean of its NEES is the degrees of freedom.
struct Consistency {
  int samples = 0;
  int degrees_of_freedom = 0;
  double mean = 0;
  double mean_low = 0;      ///< two-sided 95 % band of the mean of honest *independent* samples:
  double mean_high = 0;     ///< runs of different seeds are, the frames of one run are not
  double share_inside = 0;  ///< of the samples, below their 95 % quantile: 0.95 when honest
};

/// Nothing of no samples.
[[nodiscard]] std::optional<Consistency> consistency(std::span<const double> nees_samples,
                                                     int degrees_of_freedom);

}  // namespace stillkite
