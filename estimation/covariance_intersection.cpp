#include "estimation/covariance_intersection.hpp"

#include <Eigen/Cholesky>

namespace stillkite {

// With w the share of a: (w A^-1 + (1 - w) B^-1)^-1 = A (w B + (1 - w) A)^-1 B.
VectorEstimate covariance_intersection(const VectorEstimate& a, const VectorEstimate& b) {
  const double of_a = b.covariance.trace() / (a.covariance.trace() + b.covariance.trace());
  const Eigen::LDLT<Eigen::Matrix3d> mixed(of_a * b.covariance + (1 - of_a) * a.covariance);
  const Eigen::Matrix3d covariance = a.covariance * mixed.solve(b.covariance);
  return {a.mean + (1 - of_a) * a.covariance * mixed.solve(b.mean - a.mean),
          0.5 * (covariance + covariance.transpose())};
}

}  // namespace stillkite
