#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

#include "estimation/two_view/epipolar_error.hpp"

namespace stillkite {

/// Pairs grouped by cell of a 6 x 4 grid over their extent in the reference image.
[[nodiscard]] std::vector<BearingColumns> columns_by_cell(const BearingColumns& columns);

/// Variance inflation of a fit by spatially correlated errors, >= 1: overlapping patches share
/// their noise, and neighbours share the lens distortion error. Compares the squared cluster scores
/// sum w e g of the cells to their expectation for independent errors, reduced by the degrees of
/// freedom of the fit (cluster-robust variance: Liang and Zeger 1986, Biometrika 73).
///
/// `sums_of(columns)` returns `SampsonSums` or `TransferSums`; `J`: Jacobian of the nine entries
/// with respect to the parameters; `normal`: J^T N J of all pairs, positive definite; `variance`:
/// of one component of an influence w e, over the mean weight.
template <int kParameters>
[[nodiscard]] double cluster_variance_ratio(
    const BearingColumns& columns, const Eigen::Matrix<double, 9, kParameters>& J,
    const Eigen::Matrix<double, kParameters, kParameters>& normal, double variance,
    const auto& sums_of) {
  using Matrix = Eigen::Matrix<double, kParameters, kParameters>;
  const Eigen::LLT<Matrix> factor(normal);
  constexpr double kMinTrace = 0.25 * kParameters;  // rounding error only, if one cell holds all
  double squared_scores = 0;
  double residual_trace = 0;
  for (const BearingColumns& cell : columns_by_cell(columns)) {
    const auto sums = sums_of(cell);
    const Eigen::Matrix<double, kParameters, 1> score = J.transpose() * sums.gradient;
    const Matrix left_whitened = factor.matrixL().solve(Matrix(J.transpose() * sums.normal * J));
    const Matrix leverage = factor.matrixL().solve(left_whitened.transpose());
    squared_scores += factor.matrixL().solve(score).squaredNorm();
    residual_trace += leverage.trace() - leverage.squaredNorm();
  }
  const double expected = variance * residual_trace;
  return residual_trace > kMinTrace && squared_scores > expected ? squared_scores / expected : 1;
}

}  // namespace stillkite
