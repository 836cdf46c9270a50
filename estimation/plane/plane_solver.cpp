#include "estimation/plane/plane_solver.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/chi_square.hpp"
#include "geometry/median.hpp"

namespace stillkite {
namespace {

using Solver = Eigen::LDLT<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 8, 8>>;
using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 8, 8>;
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 8, 1>;

// Median of chi-square with two degrees of freedom, 2 ln 2.
constexpr double kMedianChi2 = kChiSquareMedian2;
constexpr std::size_t kMedianSampleSize = 512;
constexpr std::size_t kMinTiles = 8;

// 0 for an empty sample.
float median_of(std::vector<float>& values) {
  return values.empty() ? 0 : upper_median(values);
}

// Solves A x = b with A scaled to unit diagonal: lengths and angles differ in magnitude.
struct ScaledSolver {
  SmallVector scale;
  Solver ldlt;

  explicit ScaledSolver(const SmallMatrix& A)
      : scale(A.diagonal().cwiseMax(1e-12).cwiseSqrt().cwiseInverse()),
        ldlt(scale.asDiagonal() * A * scale.asDiagonal()) {}
  [[nodiscard]] bool singular() const {
    return ldlt.info() != Eigen::Success || !(ldlt.vectorD().minCoeff() > 1e-9);
  }
  [[nodiscard]] SmallMatrix solve(const SmallMatrix& b) const {
    return scale.asDiagonal() * SmallMatrix(ldlt.solve(SmallMatrix(scale.asDiagonal() * b)));
  }
};

// Tilt information with the motion marginalized (Schur complement).
Eigen::Matrix2d marginal_tilt_information(const PlaneMotionMatrix& information) {
  const Eigen::Matrix<double, 6, 2> tilt_motion_cross = information.topRightCorner<6, 2>();
  const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> motion(information.topLeftCorner<6, 6>());
  return information.bottomRightCorner<2, 2>() -
         tilt_motion_cross.transpose() * motion.solve(tilt_motion_cross);
}

}  // namespace

// k = 1 + sigma^2 A_rot. A smooth flow error acts as a rotation of all bearings by sigma and does
// not average out over the tiles. In a climb, tilt flow resembles motion flow and absorbs the
// error.
double smooth_factor(const PlaneMotionMatrix& information, double smooth_sigma_rad) {
  const double rotation_information = 0.5 * (information(3, 3) + information(4, 4));
  return 1 + smooth_sigma_rad * smooth_sigma_rad * rotation_information;
}

PlaneSolution PlaneSolver::solve(const PlaneObservations& tiles, const TiltPrior& prior,
                                 const Eigen::Vector2d& tilt_rad, double smooth_sigma_rad) {
  PlaneSolution solution;
  Eigen::Matrix2d tilt_information = Eigen::Matrix2d::Zero();
  if (prior.covariance) {
    solution.parameters = 8;
    tilt_information = prior.covariance->ldlt().solve(Eigen::Matrix2d::Identity());
  }
  const int n = solution.parameters;
  const auto count = static_cast<std::size_t>(tiles.jacobian.count);
  const std::size_t stride = 1 + count / kMedianSampleSize;
  weights_.assign(count, 1.0F);
  for (int round = 0; round <= (config_.robust ? config_.reweightings : 0); ++round) {
    // scale and weights from the residuals of the previous solution
    squared_residuals(tiles.jacobian, tiles.measurements, solution.step, tiles.min_trace(), chi2_);
    scratch_.clear();
    for (std::size_t i = 0; i < count; i += stride) {
      if (tiles.trace(i) > tiles.min_trace()) scratch_.push_back(chi2_[i]);
    }
    if (scratch_.size() * stride < kMinTiles) return solution;
    solution.noise_variance = std::max(median_of(scratch_) / kMedianChi2, 0.05);
    if (round > 0) {
      const double cutoff2 = config_.outlier_sigma * config_.outlier_sigma;
      const auto scale = static_cast<float>(1.0 / (cutoff2 * solution.noise_variance));
      for (std::size_t i = 0; i < count; ++i) {
        const float w = 1.0F / (1.0F + chi2_[i] * scale);
        weights_[i] = w * w;
      }
    }
    const NormalEquations sum = accumulate(tiles.jacobian, tiles.measurements, weights_);
    solution.information = sum.information / solution.noise_variance;
    solution.gradient = sum.gradient / solution.noise_variance;
    PlaneMotionStep gradient = solution.gradient;
    solution.smooth_factor = smooth_factor(solution.information, smooth_sigma_rad);
    if (prior.covariance) {
      // stronger prior instead of smaller tile weights: the motion covariance is unaffected
      solution.prior.bottomRightCorner<2, 2>() = solution.smooth_factor * tilt_information;
      solution.information += solution.prior;
      gradient.tail<2>() -= solution.prior.bottomRightCorner<2, 2>() * tilt_rad;
    }
    const ScaledSolver A(solution.information.topLeftCorner(n, n));
    if (A.singular()) return solution;
    const SmallMatrix step = A.solve(gradient.head(n));
    if (!step.allFinite()) return solution;
    solution.step.head(n) = step;
    solution.ok = true;
  }
  squared_residuals(tiles.jacobian, tiles.measurements, solution.step, tiles.min_trace(), chi2_);
  return solution;
}

PlaneMotionMatrix PlaneSolver::scatter(const PlaneObservations& tiles,
                                       const PlaneSolution& solution) const {
  const TileMeasurements& m = tiles.measurements;
  const TileJacobian& J = tiles.jacobian;
  std::array<Eigen::Matrix<float, 8, 1>, PlaneObservations::kClusters> cluster_gradients;
  cluster_gradients.fill(Eigen::Matrix<float, 8, 1>::Zero());
  const Eigen::Matrix<float, 8, 1> step = solution.step.cast<float>();
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    if (!(tiles.trace(i) > 0)) continue;
    float ux = 0, uy = 0;
    for (int a = 0; a < 8; ++a) {
      ux += J.x(a)[i] * step[a];
      uy += J.y(a)[i] * step[a];
    }
    const float ex = weights_[i] * (m.gx[i] - m.gxx[i] * ux - m.gxy[i] * uy);
    const float ey = weights_[i] * (m.gy[i] - m.gxy[i] * ux - m.gyy[i] * uy);
    auto& s = cluster_gradients[static_cast<std::size_t>(tiles.cluster[i])];
    for (int a = 0; a < 8; ++a) s[a] += J.x(a)[i] * ex + J.y(a)[i] * ey;
  }
  PlaneMotionMatrix scatter = PlaneMotionMatrix::Zero();
  int clusters = 0;
  for (const auto& s : cluster_gradients) {
    const PlaneMotionStep gradient = s.cast<double>() / solution.noise_variance;
    scatter += gradient * gradient.transpose();
    clusters += s.squaredNorm() > 0 ? 1 : 0;
  }
  const int n = solution.parameters;
  return scatter * (clusters > n ? static_cast<double>(clusters) / (clusters - n) : n);
}

double PlaneSolver::residual_px(const PlaneObservations& tiles) {
  scratch_.clear();
  const std::size_t stride = 1 + chi2_.size() / kMedianSampleSize;
  for (std::size_t i = 0; i < chi2_.size(); i += stride) {
    if (tiles.trace(i) > tiles.min_trace()) scratch_.push_back(chi2_[i] / tiles.trace(i));
  }
  return std::sqrt(2 * median_of(scratch_) / kMedianChi2);
}

double PlaneSolver::deviation_px(const PlaneObservations& tiles) {
  const TileMeasurements& m = tiles.measurements;
  const float floor = tiles.min_trace();
  const std::size_t stride = 1 + chi2_.size() / kMedianSampleSize;
  std::vector<float> explained, noise;
  for (std::size_t i = 0; i < chi2_.size(); i += stride) {
    if (!(tiles.trace(i) > floor)) continue;
    const float xx = m.gxx[i] + floor, yy = m.gyy[i] + floor, xy = m.gxy[i];
    const float explained_by_flow =
        (yy * m.gx[i] * m.gx[i] + xx * m.gy[i] * m.gy[i] - 2 * xy * m.gx[i] * m.gy[i]) /
        (xx * yy - xy * xy);
    // three unknowns per tile: mean and displacement
    noise.push_back(std::max(0.0F, m.residual[i] - explained_by_flow) / (tiles.pixels - 3));
    explained.push_back(chi2_[i]);
  }
  const double variance = median_of(explained) / kMedianChi2;
  if (!(variance > 0)) return 0;
  return residual_px(tiles) * std::sqrt(std::max(0.0, 1 - median_of(noise) / variance));
}

PlaneMotionStep step_without_prior(const PlaneSolution& solution) {
  constexpr double kWeakPrior = 1;  // 1/rad^2, where the tilt is not observable
  if (solution.parameters < 8) return solution.step;
  PlaneMotionMatrix information = solution.information - solution.prior;
  information.diagonal().tail<2>().array() += kWeakPrior;
  const ScaledSolver A(information);
  return A.singular() ? solution.step : PlaneMotionStep(A.solve(solution.gradient));
}

PlaneMotionMatrix covariance_of(const PlaneSolution& solution, const PlaneMotionMatrix& scatter) {
  PlaneMotionMatrix errors = scatter;
  const int n = solution.parameters;
  if (n == 8) {
    const double k = solution.smooth_factor;
    errors += k * solution.prior;
    errors.bottomRightCorner<2, 2>() +=
        (k - 1) * marginal_tilt_information(solution.information - solution.prior);
  }
  const ScaledSolver A(solution.information.topLeftCorner(n, n));
  PlaneMotionMatrix covariance = PlaneMotionMatrix::Zero();
  const SmallMatrix half = A.solve(errors.topLeftCorner(n, n));
  covariance.topLeftCorner(n, n) = A.solve(half.transpose());
  return 0.5 * (covariance + covariance.transpose());
}

Eigen::Matrix<double, 6, 6> motion_by_gradient(const PlaneSolution& solution,
                                               const Eigen::Matrix<double, 8, 6>& gradients) {
  const int n = solution.parameters;
  const ScaledSolver A(solution.information.topLeftCorner(n, n));
  return A.solve(gradients.topRows(n)).topRows<6>();
}

// Information A and scatter B of motion m and tilt t, deflation k. Conditional motion: error
// -A_mm^-1 A_mt t, covariance A_mm^-1 B_mm A_mm^-1 + (k - 1) A_mm^-1. Marginal tilt: Schur
// complements S of A and B' of B give W = S (B' + (k - 1) S)^-1 S. Most likely tilt without the
// prior of information P: S^-1 P t.
PlaneLikelihood plane_likelihood(const PlaneSolution& solution, const PlaneMotionMatrix& scatter,
                                 const Eigen::Vector2d& tilt_rad) {
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  const PlaneMotionMatrix A = solution.information - solution.prior;
  const double k = solution.smooth_factor;
  const ScaledSolver A_mm(A.topLeftCorner<6, 6>());
  PlaneLikelihood out;
  const Matrix6 half = A_mm.solve(scatter.topLeftCorner<6, 6>());
  const Matrix6 sandwich = A_mm.solve(half.transpose());
  out.covariance = 0.5 * (sandwich + sandwich.transpose());
  out.covariance += (k - 1) * Matrix6(A_mm.solve(Matrix6::Identity()));
  if (solution.parameters < 8) return out;
  out.motion_by_tilt = -A_mm.solve(A.topRightCorner<6, 2>());
  Eigen::Matrix<double, 8, 2> motion_and_tilt_by_tilt;
  motion_and_tilt_by_tilt << out.motion_by_tilt, Eigen::Matrix2d::Identity();
  const Eigen::Matrix2d S = marginal_tilt_information(A);
  const Eigen::Matrix2d errors =
      motion_and_tilt_by_tilt.transpose() * scatter * motion_and_tilt_by_tilt + (k - 1) * S;
  const Eigen::LDLT<Eigen::Matrix2d> errors_ldlt(errors);
  const Eigen::Matrix2d W = S * errors_ldlt.solve(S);
  const Eigen::Vector2d W_tilt =
      S * errors_ldlt.solve(solution.prior.bottomRightCorner<2, 2>() * tilt_rad);
  if (!W.allFinite() || !W_tilt.allFinite()) return out;
  out.tilt_information = 0.5 * (W + W.transpose());
  out.tilt_information_rad = W_tilt;
  return out;
}

}  // namespace stillkite
