#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "estimation/ego_motion/plane_motion.hpp"
#include "estimation/plane/plane_alignment_config.hpp"
#include "estimation/plane/plane_tiles.hpp"

namespace stillkite {

/// Gaussian prior of the plane normal: zero-mean rotation about two axes of the reference camera.
struct TiltPrior {
  TiltAxes axes = TiltAxes::Identity();
  std::optional<Eigen::Matrix2d> covariance;  ///< rad^2; nullopt: normal fixed
};

/// Lucas-Kanade measurements of the tiles of one pyramid level.
struct PlaneObservations {
  const TileJacobian& jacobian;
  const TileMeasurements& measurements;
  const std::vector<int>& cluster;  ///< per tile; errors are correlated within a cluster
  float pixels = 0;                 ///< per tile

  static constexpr int kClusters = 48;
  static constexpr int kClustersAcross = 8;

  /// Minimum trace of the structure tensor of a textured tile: well above that of pixel noise.
  [[nodiscard]] float min_trace() const { return 4.0F * pixels; }
  /// Trace of the structure tensor of tile `i`.
  [[nodiscard]] float trace(std::size_t i) const {
    return measurements.gxx[i] + measurements.gyy[i];
  }
};

/// Weighted least-squares step of the plane motion, and of the tilt if it has a prior covariance.
struct PlaneSolution {
  PlaneMotionStep step = PlaneMotionStep::Zero();
  PlaneMotionMatrix information = PlaneMotionMatrix::Zero();  ///< prior included
  PlaneMotionMatrix prior = PlaneMotionMatrix::Zero();
  PlaneMotionStep gradient = PlaneMotionStep::Zero();  ///< without the prior
  double smooth_factor = 1;   ///< variance factor of smooth flow errors, >= 1
  int parameters = 6;         ///< 6, or 8 with tilt
  double noise_variance = 1;  ///< of a pixel residual, grey^2; median over tiles
  bool ok = false;            ///< false: too few textured tiles or singular system
};

/// Iteratively reweighted least squares: Geman-McClure weights on the tile residuals, one global
/// robust scale (median of chi-square with two degrees of freedom).
class PlaneSolver {
 public:
  explicit PlaneSolver(const PlaneSolverConfig& config) : config_(config) {}

  /// `tilt_rad`: current rotation of the normal from its prior mean. `smooth_sigma_rad`: standard
  /// deviation of spatially smooth flow errors, which leave no residual.
  [[nodiscard]] PlaneSolution solve(const PlaneObservations& tiles, const TiltPrior& prior,
                                    const Eigen::Vector2d& tilt_rad, double smooth_sigma_rad);

  /// Cluster-robust scatter sum s s^T, s the residual gradient of one cluster of tiles (Cameron and
  /// Miller 2015, "Cluster-robust inference", eq. 11). Relief, compression and moving water
  /// correlate the flow errors of neighbours.
  [[nodiscard]] PlaneMotionMatrix scatter(const PlaneObservations& tiles,
                                          const PlaneSolution& solution) const;

  /// Weight of each tile in the last solution, 0..1.
  [[nodiscard]] const std::vector<float>& weights() const { return weights_; }

  /// Standard deviation of a tile's flow after the step, px; median over tiles.
  [[nodiscard]] double residual_px(const PlaneObservations& tiles);

  /// Part of `residual_px` in excess of pixel noise, px (F-test with medians). Pixel noise:
  /// residual after the best displacement of each tile. Requires `TileMeasurements::residual`.
  [[nodiscard]] double deviation_px(const PlaneObservations& tiles);

 private:
  PlaneSolverConfig config_;
  std::vector<float> weights_, chi2_, scratch_;
};

/// Variance factor of smooth flow errors of this standard deviation, >= 1. `information`: of the
/// tiles alone.
[[nodiscard]] double smooth_factor(const PlaneMotionMatrix& information, double smooth_sigma_rad);

/// Step to the plane that explains the tiles best, without the tilt prior.
[[nodiscard]] PlaneMotionStep step_without_prior(const PlaneSolution& solution);

/// Sandwich covariance A^-1 B A^-1, A the information of the solution, B its scatter.
[[nodiscard]] PlaneMotionMatrix covariance_of(const PlaneSolution& solution,
                                              const PlaneMotionMatrix& scatter);

/// Change of the motion for each change of the gradient (columns): A^-1 gradients.
[[nodiscard]] Eigen::Matrix<double, 6, 6> motion_by_gradient(
    const PlaneSolution& solution, const Eigen::Matrix<double, 8, 6>& gradients);

/// Gaussian likelihood of the tile measurements, without the tilt prior: motion conditional on the
/// normal, and marginal information of the tilt. Tilt angles are relative to the solution's normal.
struct PlaneLikelihood {
  /// Covariance of the motion, given the normal.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 2> motion_by_tilt = Eigen::Matrix<double, 6, 2>::Zero();
  Eigen::Matrix2d tilt_information = Eigen::Matrix2d::Zero();      ///< W; 0: tilt unobservable
  Eigen::Vector2d tilt_information_rad = Eigen::Vector2d::Zero();  ///< W times the most likely tilt
};

/// Likelihood at the solution; `tilt_rad` as in `PlaneSolver::solve`.
[[nodiscard]] PlaneLikelihood plane_likelihood(const PlaneSolution& solution,
                                               const PlaneMotionMatrix& scatter,
                                               const Eigen::Vector2d& tilt_rad);

}  // namespace stillkite
