#pragma once

#include <Eigen/Core>
#include <array>

#include "estimation/two_view/epipolar_error.hpp"
#include "estimation/two_view/relative_pose.hpp"

namespace stillkite {

/// Four poses of an essential matrix: two rotations that differ by 180 deg about t, each with t and
/// -t. Hartley and Zisserman 2004, result 9.19.
[[nodiscard]] std::array<RelativePose, 4> decompose_essential(const Eigen::Matrix3d& E);

/// Cheirality test: the pose of the four with the most pairs in front of both cameras. Counts pairs
/// with a parallax angle above `min_angle_rad`; all pairs if fewer than five have it.
[[nodiscard]] RelativePose select_by_cheirality(const Eigen::Matrix3d& E,
                                                const BearingColumns& pairs, double min_angle_rad);

}  // namespace stillkite
