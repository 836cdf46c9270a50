#include "evaluation/consistency.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "geometry/chi_square.hpp"
#include "geometry/median.hpp"

namespace stillkite {
namespace {

double share_above(std::span<const double> values, double bound) {
  const auto count = std::ranges::count_if(values, [&](double value) { return value > bound; });
  return static_cast<double>(count) / static_cast<double>(values.size());
}

double share_beyond_sigma(std::span<const double> nees_samples, int degrees_of_freedom,
                          double sigma) {
  return share_above(nees_samples, chi_square_at_sigmas(sigma, degrees_of_freedom));
}

}  // namespace

std::optional<double> nees(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance) {
  const Eigen::LLT<Eigen::Matrix3d> llt(covariance);
  if (llt.info() != Eigen::Success) return std::nullopt;
  return error.dot(llt.solve(error));
}

std::optional<Consistency> consistency(std::span<const double> nees_samples,
                                       int degrees_of_freedom) {
  if (nees_samples.size() < 2) return std::nullopt;
  const double n = static_cast<double>(nees_samples.size());
  const double bound = chi_square_quantile(0.95, degrees_of_freedom);
  const auto inside = std::count_if(nees_samples.begin(), nees_samples.end(),
                                    [bound](double value) { return value <= bound; });
  return Consistency{
      .samples = static_cast<int>(nees_samples.size()),
      .degrees_of_freedom = degrees_of_freedom,
      .mean = std::accumulate(nees_samples.begin(), nees_samples.end(), 0.0) / n,
      .mean_low = chi_square_quantile(0.025, n * degrees_of_freedom) / n,
      .mean_high = chi_square_quantile(0.975, n * degrees_of_freedom) / n,
      .share_inside = static_cast<double>(inside) / n,
      .share_beyond_3_sigma = share_beyond_sigma(nees_samples, degrees_of_freedom, 3),
      .share_beyond_5_sigma = share_beyond_sigma(nees_samples, degrees_of_freedom, 5),
      .sigma_over_rms = {}};
}

void NormalizedErrors::add(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance) {
  const std::optional<double> value = nees(error, covariance);
  if (!value) return;
  nees_.push_back(*value);
  sigma_.push_back(std::sqrt(covariance.trace()));
  squared_error_ += error.squaredNorm();
}

std::optional<Consistency> NormalizedErrors::consistency() const {
  std::optional<Consistency> result = stillkite::consistency(nees_, 3);
  if (result && squared_error_ > 0) {
    const double rms = std::sqrt(squared_error_ / static_cast<double>(nees_.size()));
    result->sigma_over_rms = median(sigma_) / rms;
  }
  return result;
}

}  // namespace stillkite
