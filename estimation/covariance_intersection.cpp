#include "estimation/covariance_intersection.hpp"

#include <Eigen/LU>

namespace stillkite {

VectorEstimate covariance_intersection(const VectorEstimate& a, const VectorEstimate& b) {
  const double share = b.covariance.trace() / (a.covariance.trace() + b.covariance.trace());
  const Eigen::Matrix3d of_a = share * a.covariance.inverse();
  const Eigen::Matrix3d of_b = (1 - share) * b.covariance.inverse();
  const Eigen::Matrix3d covariance = (of_a + of_b).inverse();
  return {covariance * (of_a * a.mean + of_b * b.mean), covariance};
}

}  // namespace stillkite
