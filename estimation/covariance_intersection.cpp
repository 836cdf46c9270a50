#include "estimation/covariance_intersection.hpp"

#include <Eigen/Cholesky>

namespace stillkite {

// (w A^-1 + (1 - w) B^-1)^-1 = A (w B + (1 - w) A)^-1 B, w the weight of a.
VectorEstimate covariance_intersection(const VectorEstimate& a, const VectorEstimate& b) {
  const double weight_a = b.covariance.trace() / (a.covariance.trace() + b.covariance.trace());
  const Eigen::LDLT<Eigen::Matrix3d> mixed(weight_a * b.covariance + (1 - weight_a) * a.covariance);
  const Eigen::Matrix3d covariance = a.covariance * mixed.solve(b.covariance);
  return {a.mean + (1 - weight_a) * a.covariance * mixed.solve(b.mean - a.mean),
          0.5 * (covariance + covariance.transpose())};
}

}  // namespace stillkite
