#pragma once

#include <Eigen/Core>

namespace stillkite {

struct VectorEstimate {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

/// One value out of two estimates of it whose errors may share anything: no more sure than either
/// allows (covariance intersection: Julier and Uhlmann 1997), weighed by the other's trace (Niehsen
/// 2002). The sum of both covariances is positive definite.
[[nodiscard]] VectorEstimate covariance_intersection(const VectorEstimate& a,
                                                     const VectorEstimate& b);

}  // namespace stillkite
