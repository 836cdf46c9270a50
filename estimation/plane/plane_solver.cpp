#include "estimation/plane/plane_solver.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/median.hpp"

namespace stillkite {
namespace {

using Solver = Eigen::LDLT<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 8, 8>>;
using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 8, 8>;
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 8, 1>;

// The median of chi-square with two degrees of freedom, 2 ln 2.
constexpr double kMedianChi2 = 1.3862943611198906;
constexpr std::size_t kEnoughForMedian = 512;
constexpr std::size_t kFewestWindows = 8;

// 0 if there is nothing to take a median of.
float median_of(std::vector<float>& values) {
  return values.empty() ? 0 : upper_median(values);
}

// Solves A x = b after scaling A to a unit diagonal, for metres and radians differ in size.
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

// A smooth error of the flow looks like a turn of all bearings by so much, whatever the number of
// windows. What it feigns of the tilt is larger, the less the tilt's own pattern of flow differs
// from that of a motion: in a climb, hardly at all.
double tilt_deflation(const PlaneMotionMatrix& information, double flow_sigma_rad) {
  const double of_a_turn = 0.5 * (information(3, 3) + information(4, 4));
  return 1 + flow_sigma_rad * flow_sigma_rad * of_a_turn;
}

// What the windows say of the tilt once the motion is taken out.
Eigen::Matrix2d tilt_alone(const PlaneMotionMatrix& information) {
  const Eigen::Matrix<double, 6, 2> with_motion = information.topRightCorner<6, 2>();
  const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> motion(information.topLeftCorner<6, 6>());
  return information.bottomRightCorner<2, 2>() -
         with_motion.transpose() * motion.solve(with_motion);
}

}  // namespace

PlaneSolution PlaneSolver::solve(const PlaneObservations& seen, const TiltPrior& tilt,
                                 const Eigen::Vector2d& tilt_now) {
  PlaneSolution best;
  Eigen::Matrix2d tilt_information = Eigen::Matrix2d::Zero();
  if (tilt.covariance) {
    best.parameters = 8;
    tilt_information = tilt.covariance->ldlt().solve(Eigen::Matrix2d::Identity());
  }
  const int n = best.parameters;
  const auto count = static_cast<std::size_t>(seen.jacobian.count);
  const std::size_t stride = 1 + count / kEnoughForMedian;
  weights_.assign(count, 1.0F);
  for (int round = 0; round <= (config_.robust ? config_.reweightings : 0); ++round) {
    // residuals at the last solution give the scale and the weights of the next
    squared_residuals(seen.jacobian, seen.measurements, best.step, seen.textured(), chi2_);
    scratch_.clear();
    for (std::size_t i = 0; i < count; i += stride) {
      if (seen.trace(i) > seen.textured()) scratch_.push_back(chi2_[i]);
    }
    if (scratch_.size() * stride < kFewestWindows) return best;
    best.noise_variance = std::max(median_of(scratch_) / kMedianChi2, 0.05);
    if (round > 0) {
      const double cutoff2 = config_.outlier_sigma * config_.outlier_sigma;
      const auto scale = static_cast<float>(1.0 / (cutoff2 * best.noise_variance));
      for (std::size_t i = 0; i < count; ++i) {
        const float w = 1.0F / (1.0F + chi2_[i] * scale);
        weights_[i] = w * w;
      }
    }
    const NormalEquations sum = accumulate(seen.jacobian, seen.measurements, weights_);
    best.information = sum.information / best.noise_variance;
    PlaneMotionStep gradient = sum.gradient / best.noise_variance;
    if (tilt.covariance) {
      // instead of less weight to the windows, more to the prior: the motion keeps its precision
      best.tilt_deflation = tilt_deflation(best.information, tilt.flow_sigma_rad);
      best.prior.bottomRightCorner<2, 2>() = best.tilt_deflation * tilt_information;
      best.information += best.prior;
      gradient.tail<2>() -= best.prior.bottomRightCorner<2, 2>() * tilt_now;
    }
    const ScaledSolver A(best.information.topLeftCorner(n, n));
    if (A.singular()) return best;
    const SmallMatrix step = A.solve(gradient.head(n));
    if (!step.allFinite()) return best;
    best.step.head(n) = step;
    best.ok = true;
  }
  squared_residuals(seen.jacobian, seen.measurements, best.step, seen.textured(), chi2_);
  return best;
}

PlaneMotionMatrix PlaneSolver::scatter(const PlaneObservations& seen,
                                       const PlaneSolution& solution) const {
  const TileMeasurements& m = seen.measurements;
  const TileJacobian& J = seen.jacobian;
  std::array<Eigen::Matrix<float, 8, 1>, PlaneObservations::kClusters> left;
  left.fill(Eigen::Matrix<float, 8, 1>::Zero());
  const Eigen::Matrix<float, 8, 1> step = solution.step.cast<float>();
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    if (!(seen.trace(i) > 0)) continue;
    float ux = 0, uy = 0;
    for (int a = 0; a < 8; ++a) {
      ux += J.x(a)[i] * step[a];
      uy += J.y(a)[i] * step[a];
    }
    const float ex = weights_[i] * (m.gx[i] - m.gxx[i] * ux - m.gxy[i] * uy);
    const float ey = weights_[i] * (m.gy[i] - m.gxy[i] * ux - m.gyy[i] * uy);
    auto& s = left[static_cast<std::size_t>(seen.cluster[i])];
    for (int a = 0; a < 8; ++a) s[a] += J.x(a)[i] * ex + J.y(a)[i] * ey;
  }
  PlaneMotionMatrix scatter = PlaneMotionMatrix::Zero();
  int clusters = 0;
  for (const auto& s : left) {
    const PlaneMotionStep gradient = s.cast<double>() / solution.noise_variance;
    scatter += gradient * gradient.transpose();
    clusters += s.squaredNorm() > 0 ? 1 : 0;
  }
  const int n = solution.parameters;
  return scatter * (clusters > n ? static_cast<double>(clusters) / (clusters - n) : n);
}

double PlaneSolver::residual_px(const PlaneObservations& seen) {
  scratch_.clear();
  const std::size_t stride = 1 + chi2_.size() / kEnoughForMedian;
  for (std::size_t i = 0; i < chi2_.size(); i += stride) {
    if (seen.trace(i) > seen.textured()) scratch_.push_back(chi2_[i] / seen.trace(i));
  }
  return std::sqrt(2 * median_of(scratch_) / kMedianChi2);
}

double PlaneSolver::deviation_px(const PlaneObservations& seen) {
  const TileMeasurements& m = seen.measurements;
  const float floor = seen.textured();
  const std::size_t stride = 1 + chi2_.size() / kEnoughForMedian;
  std::vector<float> explained, noise;
  for (std::size_t i = 0; i < chi2_.size(); i += stride) {
    if (!(seen.trace(i) > floor)) continue;
    const float xx = m.gxx[i] + floor, yy = m.gyy[i] + floor, xy = m.gxy[i];
    const float by_own_flow =
        (yy * m.gx[i] * m.gx[i] + xx * m.gy[i] * m.gy[i] - 2 * xy * m.gx[i] * m.gy[i]) /
        (xx * yy - xy * xy);
    // a window's mean and its own flow are three unknowns
    noise.push_back(std::max(0.0F, m.residual[i] - by_own_flow) / (seen.pixels - 3));
    explained.push_back(chi2_[i]);
  }
  const double variance = median_of(explained) / kMedianChi2;
  if (!(variance > 0)) return 0;
  return residual_px(seen) * std::sqrt(std::max(0.0, 1 - median_of(noise) / variance));
}

PlaneMotionMatrix covariance_of(const PlaneSolution& solution, const PlaneMotionMatrix& scatter) {
  PlaneMotionMatrix errors = scatter;
  const int n = solution.parameters;
  if (n == 8) {
    const double k = solution.tilt_deflation;
    errors += k * solution.prior;
    errors.bottomRightCorner<2, 2>() += (k - 1) * tilt_alone(solution.information - solution.prior);
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

// Of motion and tilt with information A and scatter B, k the deflation: given the tilt the motion
// is off by -A_mm^-1 A_mt tilt, with A_mm^-1 B_mm A_mm^-1 + (k - 1) A_mm^-1. Of the tilt, with the
// motion taken out, S is left of A and B' of B: W = S (B' + (k - 1) S)^-1 S. The windows alone
// would have it S^-1 P t from where it is, t from its prior P.
WindowsAlone windows_alone(const PlaneSolution& solution, const PlaneMotionMatrix& scatter,
                           const Eigen::Vector2d& tilt_now) {
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  const PlaneMotionMatrix A = solution.information - solution.prior;
  const double k = solution.tilt_deflation;
  const ScaledSolver A_mm(A.topLeftCorner<6, 6>());
  WindowsAlone out;
  const Matrix6 half = A_mm.solve(scatter.topLeftCorner<6, 6>());
  const Matrix6 sandwich = A_mm.solve(half.transpose());
  out.covariance = 0.5 * (sandwich + sandwich.transpose());
  if (solution.parameters < 8) return out;
  out.covariance += (k - 1) * Matrix6(A_mm.solve(Matrix6::Identity()));
  out.motion_by_tilt = -A_mm.solve(A.topRightCorner<6, 2>());
  Eigen::Matrix<double, 8, 2> out_of_motion;
  out_of_motion << out.motion_by_tilt, Eigen::Matrix2d::Identity();
  const Eigen::Matrix2d S = tilt_alone(A);
  const Eigen::Matrix2d errors = out_of_motion.transpose() * scatter * out_of_motion + (k - 1) * S;
  const Eigen::LDLT<Eigen::Matrix2d> of_errors(errors);
  const Eigen::Matrix2d W = S * of_errors.solve(S);
  const Eigen::Vector2d W_turn =
      S * of_errors.solve(solution.prior.bottomRightCorner<2, 2>() * tilt_now);
  if (!W.allFinite() || !W_turn.allFinite()) return out;
  out.tilt_information = 0.5 * (W + W.transpose());
  out.tilt_information_rad = W_turn;
  return out;
}

}  // namespace stillkite
