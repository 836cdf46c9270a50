#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "estimation/two_view/relative_pose.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// Relative relief: median parallax residual of a flat-ground fit over the median parallax. 0: all
/// features lie on the ground; near 1: the plane explains none of the parallax. Flat ground at
/// height h has s / Z = (s / h) n.a, with baseline s, depth Z in the reference camera and n the
/// unit normal towards the ground; above the horizon (n.a < 0) the predicted parallax is 0. Pairs
/// with `inliers` = 1 are used; `sigma`: noise of a coordinate on z = 1. std::nullopt if `pose` has
/// no direction, with fewer than 20 inliers, or if the median parallax is below 5 sigma.
[[nodiscard]] std::optional<double> ground_relief(const std::vector<BearingPair>& pairs,
                                                  const std::vector<unsigned char>& inliers,
                                                  const RelativePose& pose,
                                                  const Eigen::Vector3d& normal_in_reference,
                                                  double sigma);

/// Relative transfer residual of the ground homography H = R + t n^T / h: median residual of H over
/// the median residual of R alone. `height`: h of the reference camera, in the unit of t.
/// std::nullopt with fewer than 20 pairs, a height <= 0, or if the median residual of R is below
/// 5 sigma.
[[nodiscard]] std::optional<double> ground_misfit(const std::vector<BearingPair>& pairs,
                                                  const RigidTransform& current_from_reference,
                                                  const Eigen::Vector3d& normal_in_reference,
                                                  double height, double sigma);

}  // namespace stillkite
