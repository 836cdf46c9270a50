#include "estimation/ego_motion/twist_equations.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

namespace stillkite {
namespace {

// Scale of each unknown that gives N a unit diagonal; 1 for unknowns without information.
Vector6d unit_diagonal_scale(const Matrix6d& N) {
  return N.diagonal().unaryExpr([](double d) { return d > 0 ? 1.0 / std::sqrt(d) : 1.0; });
}

}  // namespace

TwistEquations& TwistEquations::operator+=(const TwistEquations& other) {
  N += other.N;
  b += other.b;
  return *this;
}

TwistEquations TwistEquations::operator-(const TwistEquations& other) const {
  return {N - other.N, b - other.b};
}

Vector6d solve(const TwistEquations& sums) {
  const Vector6d scale = unit_diagonal_scale(sums.N);
  const Matrix6d scaled = scale.asDiagonal() * sums.N * scale.asDiagonal();
  return scale.cwiseProduct(scaled.ldlt().solve(scale.cwiseProduct(sums.b)));
}

Matrix6d inverse_of(const Matrix6d& N) {
  const Vector6d scale = unit_diagonal_scale(N);
  const Matrix6d scaled = scale.asDiagonal() * N * scale.asDiagonal();
  const Matrix6d inverse = scaled.ldlt().solve(Matrix6d::Identity());
  return scale.asDiagonal() * inverse * scale.asDiagonal();
}

Conditioning conditioning_of(const Matrix6d& N) {
  const Vector6d scale = unit_diagonal_scale(N);
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(scale.asDiagonal() * N * scale.asDiagonal());
  const double smallest = eigen.eigenvalues()(0);
  const double largest = eigen.eigenvalues()(5);
  return {smallest > 0 ? largest / smallest : std::numeric_limits<double>::infinity(),
          eigen.eigenvectors().col(0)};
}

}  // namespace stillkite
