#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

#include "estimation/two_view/relative_pose.hpp"

namespace stillkite {

/// Essential matrices E with x_current^T E x_reference = 0, of norm sqrt(2).
struct EssentialCandidates {
  std::array<Eigen::Matrix3d, 10> essential;
  int count = 0;
};

/// Essential matrices of five pairs; none if the pairs are degenerate. E = x X + y Y + z Z + W over
/// the null space of the five epipolar constraints, with det E = 0 and 2 E E^T E = tr(E E^T) E.
/// Elimination gives a polynomial of tenth degree in z; a Gauss-Newton step on the cubic
/// constraints refines x, y, z. Source: Nister 2004, "An efficient solution to the five-point
/// relative pose problem", section 3.2.
[[nodiscard]] EssentialCandidates solve_five_point(std::span<const BearingPair, 5> pairs);

}  // namespace stillkite
