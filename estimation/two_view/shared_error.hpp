#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

#include "estimation/two_view/epipolar_error.hpp"

namespace stillkite {

/// The pairs by the cell of the reference image that they lie in, of six by four over all.
[[nodiscard]] std::vector<BearingColumns> columns_by_cell(const BearingColumns& columns);

/// How many times as large the variance of a fit to pairs is as if they erred independently; at
/// least 1. Windows that overlap share their noise, neighbours what the lens bends: what a cell's
/// pairs pull at the fit, their score sum w e g, then adds up, where independent errors would
/// cancel. Compared are the squared scores of all cells and what independent errors would make of
/// them, less what the fit has taken away (on clusters: Liang and Zeger 1986, Biometrika 73).
///
/// `sums_of(columns)` gives `SampsonSums` or `TransferSums`; `J`: their nine entries by the
/// parameters; `normal`: of all pairs, J^T N J, positive definite; `variance`: of an influence w e,
/// a component, over the mean weight.
template <int kParameters>
[[nodiscard]] double shared_error_ratio(
    const BearingColumns& columns, const Eigen::Matrix<double, 9, kParameters>& J,
    const Eigen::Matrix<double, kParameters, kParameters>& normal, double variance,
    const auto& sums_of) {
  using Matrix = Eigen::Matrix<double, kParameters, kParameters>;
  const Eigen::LLT<Matrix> factor(normal);
  constexpr double kLeastLeft = 0.25 * kParameters;  // by rounding alone, where all lies in a cell
  double squared = 0;
  double left = 0;
  for (const BearingColumns& cell : columns_by_cell(columns)) {
    const auto sums = sums_of(cell);
    const Eigen::Matrix<double, kParameters, 1> score = J.transpose() * sums.gradient;
    const Matrix half = factor.matrixL().solve(Matrix(J.transpose() * sums.normal * J));
    const Matrix share = factor.matrixL().solve(half.transpose());
    squared += factor.matrixL().solve(score).squaredNorm();
    left += share.trace() - share.squaredNorm();
  }
  const double independent = variance * left;
  return left > kLeastLeft && squared > independent ? squared / independent : 1;
}

}  // namespace stillkite
