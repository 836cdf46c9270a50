#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

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
  /// Shares beyond the quantiles of 3 and 5 sigma, probabilities 0.9973 and 1 - 5.7e-7.
  double share_beyond_3_sigma = 0;
  double share_beyond_5_sigma = 0;
  std::optional<double> sigma_over_rms;  ///< median standard deviation / RMS error, both 3-D
};

/// std::nullopt with fewer than two samples.
[[nodiscard]] std::optional<Consistency> consistency(std::span<const double> nees_samples,
                                                     int degrees_of_freedom);

/// Errors of one quantity with their covariances. Samples without a positive definite covariance
/// are not counted.
class NormalizedErrors {
 public:
  void add(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance);
  [[nodiscard]] std::optional<Consistency> consistency() const;

 private:
  std::vector<double> nees_, sigma_;
  double squared_error_ = 0;
};

}  // namespace stillkite
