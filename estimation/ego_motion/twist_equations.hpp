#pragma once

#include <Eigen/Core>

#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// Normal equations N x = b of a least-squares twist estimate.
struct TwistEquations {
  Matrix6d N = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();

  TwistEquations& operator+=(const TwistEquations& other);
  [[nodiscard]] TwistEquations operator-(const TwistEquations& other) const;
};

/// Solution of N x = b, N positive definite (Cholesky of N scaled to unit diagonal).
[[nodiscard]] Vector6d solve(const TwistEquations& sums);

/// N^-1, N positive definite.
[[nodiscard]] Matrix6d inverse_of(const Matrix6d& N);

/// Conditioning of N scaled to unit diagonal, independent of the units of the unknowns.
struct Conditioning {
  double condition = 1;  ///< largest over smallest eigenvalue; infinite if N is singular
  Vector6d weakest = Vector6d::Zero();  ///< eigenvector of the smallest eigenvalue, scaled
};
[[nodiscard]] Conditioning conditioning_of(const Matrix6d& N);

}  // namespace stillkite
