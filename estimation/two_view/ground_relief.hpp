#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "estimation/two_view/relative_pose.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// How far from flat ground seen features stand: the median of what flat ground leaves unexplained
/// of their parallax, over the median of that parallax. 0: all lie on it; near 1: it explains
/// nothing. With s the way, Z a feature's depth in the reference camera and n the unit vector to
/// the ground there, flat ground at the distance h shows s / Z = (s / h) n.a; what lies above the
/// horizon, n.a < 0, would not move. Only pairs with `inliers` 1 count; `sigma` is the noise of a
/// coordinate on z = 1. Nothing where `pose` has no direction, or where the parallax is too small
/// to tell, below five times the noise.
[[nodiscard]] std::optional<double> ground_relief(const std::vector<BearingPair>& pairs,
                                                  const std::vector<unsigned char>& inliers,
                                                  const RelativePose& pose,
                                                  const Eigen::Vector3d& normal_in_reference,
                                                  double sigma);

/// The same of a motion in metres: the median of what is left between the features and where the
/// homography H = R + t n^T / h takes them, over the median of what is left by R alone.
/// `height`: of the reference camera, in the unit of t. Nothing where that is below five times the
/// noise.
[[nodiscard]] std::optional<double> ground_misfit(const std::vector<BearingPair>& pairs,
                                                  const RigidTransform& current_from_reference,
                                                  const Eigen::Vector3d& normal_in_reference,
                                                  double height, double sigma);

}  // namespace stillkite
