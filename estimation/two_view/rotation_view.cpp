#include "estimation/two_view/rotation_view.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "estimation/two_view/cluster_variance.hpp"
#include "estimation/two_view/transfer_error.hpp"

namespace stillkite {
namespace {

// d vec([w]x R) / dw, row by row.
Eigen::Matrix<double, 9, 3> rotation_jacobian(const Eigen::Quaterniond& rotation) {
  const Eigen::Matrix3d R = rotation.toRotationMatrix();
  Eigen::Matrix<double, 9, 3> J;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Matrix3d dR = skew(Eigen::Vector3d::Unit(k)) * R;
    for (int i = 0; i < 9; ++i) J(i, k) = dR(i / 3, i % 3);
  }
  return J;
}

// Orthonormal axes of two bearings (TRIAD).
Eigen::Matrix3d triad(const Eigen::Vector3d& first, const Eigen::Vector3d& second) {
  const Eigen::Vector3d x = first.normalized();
  const Eigen::Vector3d z = first.cross(second).normalized();
  Eigen::Matrix3d axes;
  axes << x, z.cross(x), z;
  return axes;
}

}  // namespace

Eigen::Quaterniond refine_rotation(const BearingColumns& columns,
                                   Eigen::Quaterniond current_from_reference, double cutoff,
                                   int steps) {
  for (int i = 0; i < steps; ++i) {
    const TransferSums sums =
        transfer_sums(columns, current_from_reference.toRotationMatrix(), cutoff);
    const Eigen::Matrix<double, 9, 3> J = rotation_jacobian(current_from_reference);
    Eigen::Matrix3d normal = J.transpose() * sums.normal * J;
    normal.diagonal().array() += 1e-12;
    const Eigen::Vector3d step = -normal.ldlt().solve(J.transpose() * sums.gradient);
    if (!(step.norm() < 1)) break;
    current_from_reference = (so3_exp(step) * current_from_reference).normalized();
    if (step.norm() < 1e-10) break;
  }
  return current_from_reference;
}

Eigen::Quaterniond fit_rotation(const BearingColumns& columns, double threshold, int draws,
                                RandomDraws& random) {
  Eigen::Matrix3d best = Eigen::Matrix3d::Identity();
  if (columns.size() < 2) return Eigen::Quaterniond::Identity();
  // the rotation of two noisy pairs exceeds the threshold at the far side of the image
  const double wide = 3 * threshold;
  double best_cost =
      truncated_transfer_cost(columns, best, wide, static_cast<double>(columns.size()));
  for (int i = 0; i < draws; ++i) {
    const auto [p, q] = random.distinct<2>(columns.size());
    const Eigen::Matrix3d from =
        triad({columns.ax[p], columns.ay[p], 1}, {columns.ax[q], columns.ay[q], 1});
    const Eigen::Matrix3d to =
        triad({columns.bx[p], columns.by[p], 1}, {columns.bx[q], columns.by[q], 1});
    const Eigen::Matrix3d R = to * from.transpose();
    if (!R.allFinite()) continue;
    const double cost = truncated_transfer_cost(columns, R, wide, best_cost);
    if (cost >= best_cost) continue;
    best_cost = cost;
    best = R;
  }
  Eigen::Quaterniond rotation(best);
  for (const double cutoff : {4.0, 2.0}) {
    rotation = refine_rotation(columns, rotation, cutoff * threshold, 2);
  }
  return rotation;
}

Matrix6d rotation_covariance(const BearingColumns& columns,
                             const Eigen::Quaterniond& current_from_reference, double cutoff) {
  Matrix6d covariance = Matrix6d::Zero();
  const Eigen::Matrix3d R = current_from_reference.toRotationMatrix();
  const TransferSums sums = transfer_sums(columns, R, cutoff);
  if (!(sums.count > 2) || !(sums.slope > 0)) return covariance;
  const Eigen::Matrix<double, 9, 3> J = rotation_jacobian(current_from_reference);
  const Eigen::Matrix3d normal = J.transpose() * sums.normal * J;
  const double variance = sums.count / (sums.count - 1.5) * 0.5 * sums.squared_influence *
                          sums.weight / (sums.slope * sums.slope);
  const double variance_ratio = cluster_variance_ratio<3>(
      columns, J, normal, 0.5 * sums.squared_influence / sums.weight,
      [&](const BearingColumns& cell) { return transfer_sums(cell, R, cutoff); });
  const Eigen::Matrix3d step_covariance =
      variance_ratio * variance * normal.ldlt().solve(Eigen::Matrix3d::Identity());
  if (step_covariance.allFinite()) covariance.topLeftCorner<3, 3>() = step_covariance;
  return covariance;
}

Eigen::Vector3d displacement_direction(const BearingColumns& columns,
                                       const Eigen::Quaterniond& current_from_reference,
                                       double cutoff) {
  const Eigen::Matrix3d R = current_from_reference.toRotationMatrix();
  const std::vector<float> distances = transfer_distances(columns, R);
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (!(distances[i] < cutoff)) continue;
    const Eigen::Vector3d a = R * Eigen::Vector3d(columns.ax[i], columns.ay[i], 1);
    const Eigen::Vector3d m = Eigen::Vector3d(columns.bx[i], columns.by[i], 1).cross(a);
    sum += m * m.transpose();
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(sum).eigenvectors().col(0);
}

}  // namespace stillkite
