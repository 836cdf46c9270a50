#include "estimation/two_view/sampson_refinement.hpp"

#include <Eigen/Cholesky>

#include "estimation/two_view/cluster_variance.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {
namespace {

using Matrix5d = Eigen::Matrix<double, 5, 5>;
constexpr double kMaxStep_rad = 0.3;

}  // namespace

Eigen::Matrix<double, 3, 2> tangent_basis(const Eigen::Vector3d& direction) {
  // axis least aligned with the direction
  Eigen::Index axis = 0;
  direction.cwiseAbs().minCoeff(&axis);
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) = direction.cross(Eigen::Vector3d::Unit(axis)).normalized();
  basis.col(1) = direction.cross(basis.col(0));
  return basis;
}

RelativePose apply(const RelativePose& pose, const PoseStep& step) {
  const Eigen::Vector3d moved = pose.direction + tangent_basis(pose.direction) * step.tail<2>();
  return {(so3_exp(step.head<3>()) * pose.current_from_reference).normalized(), moved.normalized()};
}

Eigen::Matrix<double, 9, 5> essential_jacobian(const RelativePose& pose) {
  const Eigen::Matrix3d R = pose.current_from_reference.toRotationMatrix();
  const Eigen::Matrix3d T = skew(pose.direction);
  const Eigen::Matrix<double, 3, 2> basis = tangent_basis(pose.direction);
  Eigen::Matrix<double, 9, 5> J;
  for (int k = 0; k < 5; ++k) {
    const Eigen::Matrix3d dE = k < 3 ? Eigen::Matrix3d(T * skew(Eigen::Vector3d::Unit(k)) * R)
                                     : Eigen::Matrix3d(skew(basis.col(k - 3)) * R);
    for (int i = 0; i < 9; ++i) J(i, k) = dE(i / 3, i % 3);
  }
  return J;
}

RelativePose refine_pose(const BearingColumns& columns, RelativePose pose, double cutoff,
                         int steps) {
  for (int i = 0; i < steps; ++i) {
    const SampsonSums sums = sampson_sums(columns, essential_matrix(pose), cutoff);
    const Eigen::Matrix<double, 9, 5> J = essential_jacobian(pose);
    Matrix5d normal = J.transpose() * sums.normal * J;
    // Levenberg damping, negligible for observable steps
    normal.diagonal() += 1e-9 * normal.diagonal() + PoseStep::Constant(1e-12);
    PoseStep step = -normal.ldlt().solve(J.transpose() * sums.gradient);
    const double length = step.norm();
    if (!(length < 1e6)) return pose;
    if (length > kMaxStep_rad) step *= kMaxStep_rad / length;
    pose = apply(pose, step);
    if (length < 1e-7) break;
  }
  return pose;
}

Matrix6d pose_covariance(const BearingColumns& columns, const RelativePose& pose, double cutoff) {
  const Eigen::Matrix3d E = essential_matrix(pose);
  const SampsonSums sums = sampson_sums(columns, E, cutoff);
  if (!(sums.count > 5) || !(sums.slope > 0)) return Matrix6d::Zero();
  const Eigen::Matrix<double, 9, 5> J = essential_jacobian(pose);
  const Matrix5d normal = J.transpose() * sums.normal * J;
  const Eigen::LDLT<Matrix5d> factor(normal);
  if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 0)) {
    return Matrix6d::Zero();
  }
  // n / (n - 5) mean(psi^2) / mean(psi')^2, times mean(w) for the weighted normal matrix
  const double variance = sums.count / (sums.count - 5) * sums.squared_influence * sums.weight /
                          (sums.slope * sums.slope);
  const double variance_ratio = cluster_variance_ratio<5>(
      columns, J, normal, sums.squared_influence / sums.weight,
      [&](const BearingColumns& cell) { return sampson_sums(cell, E, cutoff); });
  const Matrix5d step_covariance = variance_ratio * variance * factor.solve(Matrix5d::Identity());
  Eigen::Matrix<double, 6, 5> error_from_step = Eigen::Matrix<double, 6, 5>::Zero();
  error_from_step.topLeftCorner<3, 3>().setIdentity();
  error_from_step.bottomRightCorner<3, 2>() = tangent_basis(pose.direction);
  const Matrix6d covariance = error_from_step * step_covariance * error_from_step.transpose();
  return covariance.allFinite() ? covariance : Matrix6d::Zero();
}

}  // namespace stillkite
