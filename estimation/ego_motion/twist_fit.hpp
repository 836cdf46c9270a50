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

/// What is known of the twist beforehand (gyro, filter): mean and inverse covariance.
struct TwistPrior {
  Twist mean;
  Matrix6d information = Matrix6d::Zero();
};

/// The minimum, with what its covariance needs.
struct TwistFit {
  Vector6d twist = Vector6d::Zero();
  double scale = 1;  ///< standard deviation of a whitened residual's component
  Conditioning conditioning;
  TwistEquations sums;                         ///< over scale^2, with the prior
  std::array<TwistEquations, kCells> cells{};  ///< weighted, without scale and prior
  double mean_weight = 1;
  double mean_slope = 1;      ///< of the influence function, see RobustWeight
  double mean_influence = 1;  ///< E[w^2 d^2] / 2, d in units of the scale
};

/// Iteratively reweighted least squares: weights in every iteration, against one scale (MAD) for
/// all rows; first with Huber's convex kernel, then with the configured one.
class TwistFitter {
 public:
  explicit TwistFitter(const LeastSquaresConfig& config) : config_(config) {}

  /// Ends at once, with the twist where it began, if the condition exceeds the configured one.
  [[nodiscard]] TwistFit fit(const FlowRows& rows, const std::optional<TwistPrior>& prior);

  /// Whitened residuals r^T G r of the rows at the last fit's twist.
  [[nodiscard]] std::span<const double> squared_distances() const { return squared_distances_; }

 private:
  [[nodiscard]] double scale_of_distances(const FlowRows& rows);
  void accumulate(const FlowRows& rows, const std::optional<TwistPrior>& prior, TwistFit& fit);
  void weigh(RobustKernel kernel, double scale);
  void measure_weights(const FlowRows& rows, TwistFit& fit) const;

  LeastSquaresConfig config_;
  std::vector<double> squared_distances_;
  std::vector<double> weights_;
  std::vector<double> sample_;
};

/// Covariance of the fit's twist in the configured form; by residuals where too few cells of the
/// image carry information.
[[nodiscard]] Matrix6d covariance_of(const TwistFit& fit, CovarianceForm form,
                                     const std::optional<TwistPrior>& prior);

}  // namespace stillkite
