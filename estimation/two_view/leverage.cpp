#include "estimation/two_view/leverage.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "estimation/two_view/sampson_refinement.hpp"

namespace stillkite {
namespace {

constexpr double kMaxLeverageRatio = 4;
constexpr int kRounds = 3;  // masking: the largest leverages hide the next ones in N

// de/dE row by row, as in SampsonSums.
Vector9d error_gradient(const Eigen::Matrix3d& E, const Eigen::Vector3d& a,
                        const Eigen::Vector3d& b) {
  const Eigen::Vector3d l = E * a, m = E.transpose() * b;
  const double squared = l.head<2>().squaredNorm() + m.head<2>().squaredNorm();
  const double norm = std::sqrt(std::max(squared, 1e-30));
  const double f = -b.dot(l) / (norm * norm * norm);
  Vector9d g;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      g[3 * i + j] =
          b[i] * a[j] / norm + f * ((i < 2 ? l[i] * a[j] : 0) + (j < 2 ? m[j] * b[i] : 0));
    }
  }
  return g;
}

}  // namespace

BearingColumns with_bounded_leverage(BearingColumns columns, const RelativePose& pose,
                                     double cutoff) {
  using Matrix5d = Eigen::Matrix<double, 5, 5>;
  const Eigen::Matrix3d E = essential_matrix(pose);
  const Eigen::Matrix<double, 9, 5> J = essential_jacobian(pose);
  Eigen::Matrix<double, 5, Eigen::Dynamic> gradients(5, columns.size());
  for (std::size_t i = 0; i < columns.size(); ++i) {
    gradients.col(static_cast<Eigen::Index>(i)) =
        J.transpose() *
        error_gradient(E, {columns.ax[i], columns.ay[i], 1}, {columns.bx[i], columns.by[i], 1});
  }
  for (int round = 0; round < kRounds; ++round) {
    const SampsonSums sums = sampson_sums(columns, E, cutoff);
    const Matrix5d normal = J.transpose() * sums.normal * J;
    const Eigen::LLT<Matrix5d> factor(normal);
    if (factor.info() != Eigen::Success || !(sums.weight > 5)) return columns;
    const double max_leverage = kMaxLeverageRatio * 5 / sums.weight;
    const Matrix5d whitening = factor.matrixL().solve(Matrix5d::Identity());
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const Eigen::Matrix<double, 5, 1> g = gradients.col(static_cast<Eigen::Index>(i));
      const double leverage = (whitening * g).squaredNorm();
      columns.weight[i] = leverage > max_leverage ? max_leverage / leverage : 1;
      columns.fweight[i] = static_cast<float>(columns.weight[i]);
    }
  }
  return columns;
}

}  // namespace stillkite
