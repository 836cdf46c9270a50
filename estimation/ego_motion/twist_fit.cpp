#include "estimation/ego_motion/twist_fit.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "geometry/median.hpp"

namespace stillkite {
namespace {

// Lower bound of the scale, px: exact flow leaves rounding errors only.
constexpr double kMinScale = 1e-9;
// Iterations with the convex kernel before the configured one.
constexpr int kConvexSteps = 3;
// Bound of the run time; the iterations end earlier once they have converged.
constexpr int kMaxIterations = 15;

TwistEquations scaled(const TwistEquations& sums, double scale) {
  const double inverse_variance = 1 / (scale * scale);
  return {inverse_variance * sums.N, inverse_variance * sums.b};
}

TwistEquations combine(const TwistFit& fit, const std::optional<TwistPrior>& prior) {
  TwistEquations all;
  for (const TwistEquations& cell : fit.cells) all += cell;
  all = scaled(all, fit.scale);
  if (prior) all += {prior->information, prior->information * prior->mean.vector()};
  return all;
}

// Independent errors: s^2 E[w^2 d^2 / 2] / E[slope]^2 times N^-1, unweighted (Huber 1981, 7.6).
Matrix6d covariance_by_residuals(const TwistFit& fit) {
  const double factor = fit.mean_influence * fit.mean_weight / (fit.mean_slope * fit.mean_slope);
  return factor * inverse_of(fit.sums.N);
}

// Delete-one-cell jackknife; nullopt if too few cells carry information.
std::optional<Matrix6d> covariance_by_cells(const TwistFit& fit,
                                            const std::optional<TwistPrior>& prior) {
  Matrix6d spread = Matrix6d::Zero();
  int occupied = 0;
  for (const TwistEquations& cell : fit.cells) {
    if (!(cell.N.trace() > 0)) continue;
    ++occupied;
    const Vector6d change = solve(fit.sums - scaled(cell, fit.scale)) - fit.twist;
    spread += change * change.transpose();
  }
  constexpr int kMinCells = 16;
  if (occupied < kMinCells || !spread.allFinite()) return std::nullopt;
  // n / (n - 7): E[NEES] = 6 for a covariance estimated with n degrees of freedom (Hotelling)
  const double n = occupied - 1;
  const double slope_ratio = fit.mean_weight / fit.mean_slope;
  Matrix6d covariance = n / occupied * n / (n - 7) * slope_ratio * slope_ratio * spread;
  if (prior) {
    const Matrix6d inverse = inverse_of(fit.sums.N);
    covariance += inverse * prior->information * inverse;
  }
  return covariance;
}

}  // namespace

TwistFit TwistFitter::fit(const FlowRows& rows, const std::optional<TwistPrior>& prior) {
  const bool robust = config_.weighting == Weighting::robust;
  squared_distances_.resize(rows.size());
  weights_.assign(rows.size(), 1.0);
  TwistFit fit;
  if (prior) {  // the metric prior needs the flow noise scale in the first iteration
    fit.twist = prior->mean.vector();
    compute_squared_distances(rows, fit.twist, squared_distances_);
    fit.scale = estimate_scale(rows);
  }
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    if (robust && iteration > 0) {
      update_weights(iteration <= kConvexSteps ? RobustKernel::huber : config_.kernel, fit.scale);
    }
    accumulate(rows, prior, fit);
    if (iteration == 0) {
      fit.conditioning = conditioning_of(fit.sums.N);
      if (!(fit.conditioning.condition <= config_.max_condition)) break;
    }
    const Vector6d step = solve(fit.sums) - fit.twist;
    const double step_squared = step.dot(fit.sums.N * step);  // squared Mahalanobis length
    fit.twist += step;
    compute_squared_distances(rows, fit.twist, squared_distances_);
    fit.scale = estimate_scale(rows);
    if (!robust && !prior) break;
    constexpr double kConverged = 1e-4;
    if (iteration > kConvexSteps && step_squared < kConverged) break;
  }
  average_weights(rows, fit);
  fit.sums = combine(fit, prior);
  fit.conditioning = conditioning_of(fit.sums.N);
  return fit;
}

double TwistFitter::estimate_scale(const FlowRows& rows) {
  // accuracy of the median: about 1 %
  constexpr std::size_t kMedianSampleSize = 2048;
  const bool robust = config_.weighting == Weighting::robust;
  const std::size_t stride = robust ? rows.size() / kMedianSampleSize + 1 : 1;
  sample_.clear();
  for (std::size_t i = 0; i < rows.size(); i += stride) {
    if (rows.max_information[i] > 0) sample_.push_back(squared_distances_[i]);
  }
  if (sample_.empty()) return 1;
  const auto n = static_cast<double>(sample_.size());
  const double dof_ratio = std::max(0.5, 1 - 3 / n);  // six of 2 n degrees of freedom are fitted
  const double squared = robust ? upper_median(sample_) / (kRayleighMedian * kRayleighMedian)
                                : 0.5 * std::accumulate(sample_.begin(), sample_.end(), 0.0) / n;
  return std::max(std::sqrt(squared / dof_ratio), kMinScale);
}

void TwistFitter::update_weights(RobustKernel kernel, double scale) {
  const double inverse_variance = 1 / (scale * scale);
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    weights_[i] = robust_weight(kernel, inverse_variance * squared_distances_[i]).weight;
  }
}

void TwistFitter::accumulate(const FlowRows& rows, const std::optional<TwistPrior>& prior,
                             TwistFit& fit) {
  for (std::size_t cell = 0; cell < kCells; ++cell) {
    fit.cells[cell] =
        weighted_sums(rows, rows.cell_begin[cell], rows.cell_begin[cell + 1], weights_);
  }
  fit.sums = combine(fit, prior);
}

void TwistFitter::average_weights(const FlowRows& rows, TwistFit& fit) const {
  const double inverse_variance = 1 / (fit.scale * fit.scale);
  int n = 0;
  RobustWeight sum{0, 0};
  double influence = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows.max_information[i] == 0) continue;
    const double d2 = inverse_variance * squared_distances_[i];
    const RobustWeight w = config_.weighting == Weighting::robust
                               ? robust_weight(config_.kernel, d2)
                               : RobustWeight{1, 1};
    ++n;
    sum.weight += w.weight;
    sum.slope += w.slope;
    influence += 0.5 * w.weight * w.weight * d2;
  }
  fit.mean_weight = sum.weight / n;
  fit.mean_influence = influence / n;
  // bound against division by zero: a slope near zero means mostly outliers, rejected by the
  // verdict
  fit.mean_slope = std::max(sum.slope / n, 0.1 * fit.mean_weight);
}

Matrix6d covariance_of(const TwistFit& fit, CovarianceForm form,
                       const std::optional<TwistPrior>& prior) {
  if (form == CovarianceForm::cells) {
    if (const auto by_cells = covariance_by_cells(fit, prior)) return *by_cells;
  }
  return covariance_by_residuals(fit);
}

}  // namespace stillkite
