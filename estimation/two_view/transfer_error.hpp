#pragma once

#include <Eigen/Core>
#include <vector>

#include "estimation/two_view/epipolar_error.hpp"

namespace stillkite {

/// Distance of a pair to a homography b ~ H a, first order in the noise of both points:
/// d^2 = r^T (I + A A^T)^-1 r with r = b - pi(H a), A = d pi(H a)/da. d / sigma has the
/// distribution chi with two degrees of freedom, sigma the noise of a coordinate. Hartley and
/// Zisserman 2004, eq. (4.13).
/// Infinite where H a lies behind the camera.
[[nodiscard]] double transfer_error(const Eigen::Matrix3d& H, const BearingPair& pair);

/// What a step of iteratively reweighted least squares over H needs, with Tukey's weights of u =
/// d^2 / cutoff^2; as SampsonSums, for two components.
struct TransferSums {
  Matrix9d normal = Matrix9d::Zero();    ///< sum w G^T (I + A A^T)^-1 G, G = d pi(H a)/dH
  Vector9d gradient = Vector9d::Zero();  ///< sum w G^T (I + A A^T)^-1 (pi(H a) - b)
  double squared_influence = 0;          ///< sum (w d)^2
  double slope = 0;                      ///< sum of the influence's mean derivative
  double weight = 0;                     ///< sum w
  double count = 0;                      ///< pairs within the cutoff
};
[[nodiscard]] TransferSums transfer_sums(const BearingColumns& columns, const Eigen::Matrix3d& H,
                                         double cutoff);

/// d of each pair, in the order of the columns.
[[nodiscard]] std::vector<float> transfer_distances(const BearingColumns& columns,
                                                    const Eigen::Matrix3d& H);

/// Sum of min(d^2 / threshold^2, 1), given up as truncated_cost does.
[[nodiscard]] double truncated_transfer_cost(const BearingColumns& columns,
                                             const Eigen::Matrix3d& H, double threshold,
                                             double worst);

}  // namespace stillkite
