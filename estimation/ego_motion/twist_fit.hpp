#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "estimation/ego_motion/flow_rows.hpp"
#include "estimation/ego_motion/least_squares_config.hpp"
#include "estimation/ego_motion/twist_equations.hpp"
#include "estimation/twist.hpp"

namespace stillkite {

/// Gaussian prior of the twist (gyro, filter): mean and inverse covariance.
struct TwistPrior {
  Twist mean;
  Matrix6d information = Matrix6d::Zero();
};

/// Least-squares solution and the sums for its covariance.
struct TwistFit {
  Vector6d twist = Vector6d::Zero();
  double scale = 1;  ///< standard deviation of a component of the whitened residual
  Conditioning conditioning;
  TwistEquations sums;                         ///< divided by scale^2, prior included
  std::array<TwistEquations, kCells> cells{};  ///< weighted, without scale or prior
  double mean_weight = 1;
  double mean_slope = 1;      ///< of the influence function, see RobustWeight
  double mean_influence = 1;  ///< E[w^2 d^2] / 2, d in units of the scale
};

/// Iteratively reweighted least squares with one robust scale (MAD) for all rows: first Huber's
/// convex kernel, then the configured one.
class TwistFitter {
 public:
  explicit TwistFitter(const LeastSquaresConfig& config) : config_(config) {}

  /// Returns the initial twist if the condition number exceeds `max_condition`.
  [[nodiscard]] TwistFit fit(const FlowRows& rows, const std::optional<TwistPrior>& prior);

  /// Squared whitened residuals r^T G r of the rows at the twist of the last fit.
  [[nodiscard]] std::span<const double> squared_distances() const { return squared_distances_; }

 private:
  [[nodiscard]] double estimate_scale(const FlowRows& rows);
  void accumulate(const FlowRows& rows, const std::optional<TwistPrior>& prior, TwistFit& fit);
  void update_weights(RobustKernel kernel, double scale);
  void average_weights(const FlowRows& rows, TwistFit& fit) const;

  LeastSquaresConfig config_;
  std::vector<double> squared_distances_;
  std::vector<double> weights_;
  std::vector<double> sample_;
};

/// Covariance of the fitted twist, 6x6, camera frame. Falls back to `CovarianceForm::residuals` if
/// too few cells carry information.
[[nodiscard]] Matrix6d covariance_of(const TwistFit& fit, CovarianceForm form,
                                     const std::optional<TwistPrior>& prior);

}  // namespace stillkite
