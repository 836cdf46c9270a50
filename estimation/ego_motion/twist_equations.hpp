#pragma once

#include <Eigen/Core>

#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// The normal equations of a least squares for the six numbers of a twist: N x = b.
struct TwistEquations {
  Matrix6d N = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();

  TwistEquations& operator+=(const TwistEquations& other);
  [[nodiscard]] TwistEquations operator-(const TwistEquations& other) const;
};

/// x of N x = b, N positive definite (Cholesky of N scaled to unit diagonal).
[[nodiscard]] Vector6d solve(const TwistEquations& sums);

/// N^-1, N positive definite.
[[nodiscard]] Matrix6d inverse_of(const Matrix6d& N);

/// How well N determines its unknowns, their units aside: N is scaled to unit diagonal first.
struct Conditioning {
  double condition = 1;  ///< largest over smallest eigenvalue; infinite if N is singular
  Vector6d weakest = Vector6d::Zero();  ///< eigenvector of the smallest, in scaled coordinates
};
[[nodiscard]] Conditioning conditioning_of(const Matrix6d& N);

}  // namespace stillkite
