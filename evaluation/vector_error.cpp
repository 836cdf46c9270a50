#include "evaluation/vector_error.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include "geometry/median.hpp"

namespace stillkite {
namespace {

std::optional<double> correlation(const Eigen::ArrayXd& a, const Eigen::ArrayXd& b) {
  const Eigen::ArrayXd da = a - a.mean();
  const Eigen::ArrayXd db = b - b.mean();
  const double scale = std::sqrt(da.square().sum() * db.square().sum());
  if (!(scale > 0)) return std::nullopt;
  return (da * db).sum() / scale;
}

}  // namespace

std::optional<VectorError> vector_error(std::span<const Eigen::Vector3d> estimate,
                                        std::span<const Eigen::Vector3d> truth) {
  assert(estimate.size() == truth.size());
  if (estimate.size() < 2) return std::nullopt;
  const auto n = static_cast<Eigen::Index>(estimate.size());
  VectorError result{.samples = static_cast<int>(n)};
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    Eigen::ArrayXd a(n);
    Eigen::ArrayXd b(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      a(i) = estimate[static_cast<std::size_t>(i)](axis);
      b(i) = truth[static_cast<std::size_t>(i)](axis);
    }
    const Eigen::ArrayXd error = (a - b).abs();
    result.rmse(axis) = std::sqrt(error.square().mean());
    result.median_abs(axis) = median({error.begin(), error.end()});
    result.correlation[static_cast<std::size_t>(axis)] = correlation(a, b);
  }
  return result;
}

}  // namespace stillkite
