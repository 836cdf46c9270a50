#pragma once

#include <Eigen/Core>
#include <array>

#include "estimation/two_view/epipolar_error.hpp"
#include "estimation/two_view/relative_pose.hpp"

namespace stillkite {

/// The four poses of an essential matrix: two rotations, half a turn about t apart, each with t and
/// -t. Hartley and Zisserman 2004, result 9.19.
[[nodiscard]] std::array<RelativePose, 4> decompose_essential(const Eigen::Matrix3d& E);

/// The one of the four that has most pairs in front of both cameras, of those pairs whose rays meet
/// at more than `least_angle` (rad; of all where fewer than five do so).
[[nodiscard]] RelativePose pose_in_front(const Eigen::Matrix3d& E, const BearingColumns& pairs,
                                         double least_angle);

}  // namespace stillkite
