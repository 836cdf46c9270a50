#pragma once

#include <Eigen/Core>
#include <vector>

#include "estimation/two_view/epipolar_error.hpp"

namespace stillkite {

/// Sampson distance of a pair to a homography b ~ H a, on z = 1: d^2 = r^T (I + A A^T)^-1 r with
/// r = b - pi(H a), A = d pi(H a)/da. d / sigma is chi-distributed with two degrees of freedom,
/// sigma the noise of a coordinate. Infinite if H a is behind the camera. Hartley and Zisserman
/// 2004, eq. (4.13).
[[nodiscard]] double transfer_error(const Eigen::Matrix3d& H, const BearingPair& pair);

/// Sums of one iteratively reweighted least-squares step over H with Tukey weights of
/// u = d^2 / cutoff^2; two-component analogue of SampsonSums.
struct TransferSums {
  Matrix9d normal = Matrix9d::Zero();    ///< sum w G^T (I + A A^T)^-1 G, G = d pi(H a)/dH
  Vector9d gradient = Vector9d::Zero();  ///< sum w G^T (I + A A^T)^-1 (pi(H a) - b)
  double squared_influence = 0;          ///< sum (w d)^2
  double slope = 0;                      ///< sum of the mean derivative of the influence
  double weight = 0;                     ///< sum w
  double count = 0;                      ///< pairs within the cutoff
};
[[nodiscard]] TransferSums transfer_sums(const BearingColumns& columns, const Eigen::Matrix3d& H,
                                         double cutoff);

/// d of each pair, in the order of the columns.
[[nodiscard]] std::vector<float> transfer_distances(const BearingColumns& columns,
                                                    const Eigen::Matrix3d& H);

/// MSAC cost: sum of min(d^2 / threshold^2, 1), with the early stop of `truncated_cost`.
[[nodiscard]] double truncated_transfer_cost(const BearingColumns& columns,
                                             const Eigen::Matrix3d& H, double threshold,
                                             double cost_limit);

}  // namespace stillkite
