#include "evaluation/consistency.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <numeric>

#include "evaluation/chi_square.hpp"

namespace stillkite {

std::optional<double> nees(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance) {
  const Eigen::LLT<Eigen::Matrix3d> llt(covariance);
  if (llt.info() != Eigen::Success) return std::nullopt;
  return error.dot(llt.solve(error));
}

std::optional<Consistency> consistency(std::span<const double> nees_samples,
                                       int degrees_of_freedom) {
  if (nees_samples.empty()) return std::nullopt;
  const double n = static_cast<double>(nees_samples.size());
  const double bound = chi_square_quantile(0.95, degrees_of_freedom);
  const auto inside = std::count_if(nees_samples.begin(), nees_samples.end(),
                                    [bound](double value) { return value <= bound; });
  return Consistency{.samples = static_cast<int>(nees_samples.size()),
                     .degrees_of_freedom = degrees_of_freedom,
                     .mean = std::accumulate(nees_samples.begin(), nees_samples.end(), 0.0) / n,
                     .mean_low = chi_square_quantile(0.025, n * degrees_of_freedom) / n,
                     .mean_high = chi_square_quantile(0.975, n * degrees_of_freedom) / n,
                     .share_inside = static_cast<double>(inside) / n};
}

}  // namespace stillkite
