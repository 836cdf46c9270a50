#include "estimation/sliding_window/epipolar_rotation.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "estimation/robust_kernel.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

namespace {

// Residual t . n of a match, in variances; `line` is its derivative with respect to R b.
struct Residual {
  Eigen::Vector3d n, line;
  double variance;
};

Residual residual_of(const BearingMatch& match, const Eigen::Matrix3d& rotation,
                     const Eigen::Vector3d& t) {
  constexpr double kMinLever2 = 0.01;  // a bearing along the translation constrains nothing
  const Eigen::Vector3d line = t.cross(match.first);
  return {match.first.cross(rotation * match.second), line,
          2 * match.variance * std::max(kMinLever2, line.squaredNorm())};
}

double weight_of(const Residual& residual, const Eigen::Vector3d& t, bool is_robust) {
  const double r = t.dot(residual.n);
  const double weight =
      is_robust ? robust_weight(RobustKernel::geman_mcclure, r * r / residual.variance).weight : 1;
  return weight / residual.variance;
}

using Directions = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>;

// The translation's direction is the first eigenvector.
Directions translation_direction(std::span<const BearingMatch> matches,
                                 const Eigen::Matrix3d& rotation, bool is_robust) {
  constexpr int kRounds = 4;  // of the weights
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
  for (const BearingMatch& match : matches) {
    const Eigen::Vector3d n = match.first.cross(rotation * match.second);
    moment += n * n.transpose();
  }
  Directions directions(moment);
  for (int round = 0; is_robust && round < kRounds; ++round) {
    const Eigen::Vector3d t = directions.eigenvectors().col(0);
    moment.setZero();
    for (const BearingMatch& match : matches) {
      const Residual residual = residual_of(match, rotation, t);
      moment += weight_of(residual, t, true) * residual.n * residual.n.transpose();
    }
    directions.compute(moment);
  }
  return directions;
}

}  // namespace

RotationEquations epipolar_equations(std::span<const BearingMatch> matches,
                                     const Eigen::Matrix3d& rotation, bool is_robust) {
  const Directions directions = translation_direction(matches, rotation, is_robust);
  const Eigen::Vector3d t = directions.eigenvectors().col(0);
  const Eigen::Matrix<double, 3, 2> tangent = directions.eigenvectors().rightCols<2>();
  RotationEquations out;
  Eigen::Matrix2d D = Eigen::Matrix2d::Zero();
  Eigen::Matrix<double, 3, 2> C = Eigen::Matrix<double, 3, 2>::Zero();
  Eigen::Vector2d d = Eigen::Vector2d::Zero();
  for (const BearingMatch& match : matches) {
    const Residual residual = residual_of(match, rotation, t);
    const double weight = weight_of(residual, t, is_robust);
    const double r = t.dot(residual.n);
    const Eigen::RowVector3d J = -residual.line.transpose() * rotation * skew(match.second);
    const Eigen::RowVector2d K = residual.n.transpose() * tangent;
    out.H += weight * J.transpose() * J;
    out.g -= weight * r * J.transpose();
    C += weight * J.transpose() * K;
    D += weight * K.transpose() * K;
    d -= weight * r * K.transpose();
  }
  D.diagonal().array() += 1e-9 * D.trace() + 1e-9;
  const Eigen::Matrix<double, 3, 2> C_inverse = C * D.inverse();
  out.H -= C_inverse * C.transpose();
  out.g -= C_inverse * d;
  return out;
}

std::optional<Eigen::Quaterniond> epipolar_rotation(std::span<const BearingMatch> matches,
                                                    const Eigen::Quaterniond& initial) {
  constexpr std::size_t kMinMatches = 12;
  constexpr int kLeastSquares = 3;  // iterations before the robust ones
  constexpr int kMaxIterations = 20;
  constexpr double kMinStep_rad = 1e-6;
  constexpr double kMaxSigma_ratio = 0.1;
  if (matches.size() < kMinMatches) return std::nullopt;
  Eigen::Quaterniond rotation = initial;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const RotationEquations equations =
        epipolar_equations(matches, rotation.toRotationMatrix(), iteration >= kLeastSquares);
    const Eigen::LLT<Eigen::Matrix3d> factor(equations.H);
    const Eigen::Vector3d step = factor.solve(equations.g);
    if (factor.info() != Eigen::Success || !step.allFinite()) return std::nullopt;
    rotation = (rotation * so3_exp(step)).normalized();
    if (iteration < kLeastSquares || step.norm() >= kMinStep_rad) continue;
    const Eigen::Matrix3d covariance = factor.solve(Eigen::Matrix3d::Identity());
    const double sigma_rad = std::sqrt(covariance.trace());
    if (sigma_rad > kMaxSigma_ratio * so3_log(rotation).norm()) return std::nullopt;
    return rotation;
  }
  return std::nullopt;
}

}  // namespace stillkite
