#include "estimation/two_view/homography.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

#include "estimation/two_view/cluster_variance.hpp"
#include "estimation/two_view/sampson_refinement.hpp"
#include "estimation/two_view/transfer_error.hpp"

namespace stillkite {
namespace {

using Vector8d = Eigen::Matrix<double, 8, 1>;
using Matrix8d = Eigen::Matrix<double, 8, 8>;
using HomographyJacobian = Eigen::Matrix<double, 9, 8>;

// d vec(H) / d(w, s, n): [w]x R, ds n^T, s (B u)^T.
HomographyJacobian homography_jacobian(const PlaneMotion& motion) {
  const Eigen::Matrix3d R = motion.rotation.toRotationMatrix();
  const Eigen::Matrix<double, 3, 2> basis = tangent_basis(motion.normal);
  HomographyJacobian J;
  for (int k = 0; k < 8; ++k) {
    Eigen::Matrix3d dH;
    if (k < 3) {
      dH = skew(Eigen::Vector3d::Unit(k)) * R;
    } else if (k < 6) {
      dH = Eigen::Vector3d::Unit(k - 3) * motion.normal.transpose();
    } else {
      dH = motion.translation * basis.col(k - 6).transpose();
    }
    for (int i = 0; i < 9; ++i) J(i, k) = dH(i / 3, i % 3);
  }
  return J;
}

// h22 = 1 is valid: points near the optical axis stay in front of the camera.
Eigen::Matrix3d homography_from_four_pairs(const BearingColumns& c,
                                           const std::array<std::size_t, 4>& indices) {
  Matrix8d A = Matrix8d::Zero();
  Vector8d b;
  for (int k = 0; k < 4; ++k) {
    const std::size_t i = indices[static_cast<std::size_t>(k)];
    A.row(2 * k) << c.ax[i], c.ay[i], 1, 0, 0, 0, -c.bx[i] * c.ax[i], -c.bx[i] * c.ay[i];
    A.row(2 * k + 1) << 0, 0, 0, c.ax[i], c.ay[i], 1, -c.by[i] * c.ax[i], -c.by[i] * c.ay[i];
    b[2 * k] = c.bx[i];
    b[2 * k + 1] = c.by[i];
  }
  const Vector8d h = A.partialPivLu().solve(b);
  Eigen::Matrix3d H;
  H << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], 1;
  return H;
}

PlaneMotion with_forward_normal(const Eigen::Matrix3d& R, const Eigen::Matrix3d& H,
                                const Eigen::Vector3d& normal) {
  const double sign = normal.z() < 0 ? -1 : 1;
  return {Eigen::Quaterniond(R).normalized(), sign * ((H - R) * normal), sign * normal};
}

}  // namespace

std::array<PlaneMotion, 2> decompose_homography(const Eigen::Matrix3d& scaled_homography) {
  // middle singular value 1; sign from points in front: det(R + s n^T) = 1 + n^T R^T s > 0
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(scaled_homography.transpose() *
                                                             scaled_homography);
  const double middle = std::sqrt(std::max(eigen.eigenvalues()[1], 1e-300));
  const Eigen::Matrix3d H =
      scaled_homography / std::copysign(middle, scaled_homography.determinant());
  const Eigen::Vector3d squares = eigen.eigenvalues() / (middle * middle);
  const double above = std::max(squares[2] - 1, 0.0), below = std::max(1 - squares[0], 0.0);
  const Eigen::Vector3d v1 = eigen.eigenvectors().col(2), v2 = eigen.eigenvectors().col(1);
  const Eigen::Vector3d v3 = v1.cross(v2);
  if (above + below < 1e-18) {
    const PlaneMotion rotation{Eigen::Quaterniond(H).normalized(), Eigen::Vector3d::Zero(),
                               Eigen::Vector3d::UnitZ()};
    return {rotation, rotation};
  }
  std::array<PlaneMotion, 2> motions;
  for (std::size_t k = 0; k < 2; ++k) {
    const double sign = k == 0 ? 1 : -1;
    const Eigen::Vector3d u =
        (std::sqrt(below) * v1 + sign * std::sqrt(above) * v3) / std::sqrt(above + below);
    Eigen::Matrix3d U, W;
    U << v2, u, v2.cross(u);
    const Eigen::Vector3d Hv = H * v2, Hu = H * u;
    W << Hv, Hu, Hv.cross(Hu);
    motions[k] = with_forward_normal(W * U.transpose(), H, v2.cross(u));
  }
  return motions;
}

Eigen::Matrix3d refine_homography(const BearingColumns& columns, Eigen::Matrix3d H, double cutoff,
                                  int steps) {
  for (int i = 0; i < steps; ++i) {
    H /= H.norm();
    const TransferSums sums = transfer_sums(columns, H, cutoff);
    const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rows = H;
    const Vector9d h = Eigen::Map<const Vector9d>(rows.data());
    // h h^T fixes the scale gauge
    Matrix9d normal = sums.normal + sums.normal.trace() * h * h.transpose();
    normal.diagonal().array() += 1e-12 * sums.normal.trace() + 1e-300;
    const Vector9d step = -normal.ldlt().solve(sums.gradient);
    if (!(step.norm() < 0.5)) break;
    H += Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(step.data());
    if (step.norm() < 1e-8) break;
  }
  return H;
}

Eigen::Matrix3d fit_homography(const BearingColumns& columns, double threshold, int draws,
                               RandomDraws& random) {
  Eigen::Matrix3d best = Eigen::Matrix3d::Identity();
  double best_cost = static_cast<double>(columns.size());
  for (int i = 0; i < draws && columns.size() >= 4; ++i) {
    const Eigen::Matrix3d H =
        homography_from_four_pairs(columns, random.distinct<4>(columns.size()));
    if (!H.allFinite()) continue;
    const double cost = truncated_transfer_cost(columns, H, 2 * threshold, best_cost);
    if (cost >= best_cost) continue;
    best_cost = cost;
    best = H;
  }
  for (const double cutoff : {4.0, 2.0}) {
    best = refine_homography(columns, best, cutoff * threshold, 3);
  }
  return best;
}

Matrix6d plane_covariance(const BearingColumns& columns, const PlaneMotion& motion, double cutoff) {
  const Eigen::Matrix3d H = motion.homography();
  const TransferSums sums = transfer_sums(columns, H, cutoff);
  const double length = motion.translation.norm();
  if (!(sums.count > 4) || !(sums.slope > 0) || !(length > 0)) return Matrix6d::Zero();
  const HomographyJacobian J = homography_jacobian(motion);
  const Matrix8d normal = J.transpose() * sums.normal * J;
  const Eigen::LDLT<Matrix8d> factor(normal);
  if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 0)) {
    return Matrix6d::Zero();
  }
  const double variance = sums.count / (sums.count - 4) * 0.5 * sums.squared_influence *
                          sums.weight / (sums.slope * sums.slope);
  const double variance_ratio = cluster_variance_ratio<8>(
      columns, J, normal, 0.5 * sums.squared_influence / sums.weight,
      [&](const BearingColumns& cell) { return transfer_sums(cell, H, cutoff); });
  const Matrix8d step_covariance = variance_ratio * variance * factor.solve(Matrix8d::Identity());
  // direction error: the component orthogonal to t
  const Eigen::Vector3d t = motion.translation / length;
  Matrix6d error_from_step = Matrix6d::Identity();
  error_from_step.bottomRightCorner<3, 3>() =
      (Eigen::Matrix3d::Identity() - t * t.transpose()) / length;
  const Matrix6d covariance =
      error_from_step * step_covariance.topLeftCorner<6, 6>() * error_from_step.transpose();
  return covariance.allFinite() ? covariance : Matrix6d::Zero();
}

}  // namespace stillkite
