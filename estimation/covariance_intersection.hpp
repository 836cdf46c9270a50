#pragma once

#include <Eigen/Core>

namespace stillkite {

/// Estimate of a 3-vector: mean and error covariance.
struct VectorEstimate {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

/// Fuses two estimates of one vector whose error correlation is unknown: covariance intersection
/// (Julier and Uhlmann 1997),
///
///     P^-1 = w A^-1 + (1 - w) B^-1,   w = tr B / (tr A + tr B) (Niehsen 2002).
///
/// The result is consistent for any correlation of the two errors. Precondition: A + B is positive
/// definite.
[[nodiscard]] VectorEstimate covariance_intersection(const VectorEstimate& a,
                                                     const VectorEstimate& b);

}  // namespace stillkite
