#include "estimation/sliding_window/image_gyro_bias.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <utility>
#include <vector>

#include "estimation/robust_kernel.hpp"

namespace stillkite {
namespace {

struct BearingMatch {
  Eigen::Vector3d first, second;
  double variance;  // of one component
};

// Two frames with the rotation between them.
struct RotatedPair {
  ImuPreintegration imu;
  std::vector<BearingMatch> matches;
};

std::vector<RotatedPair> rotated_pairs(const Window& window) {
  constexpr std::size_t kStrides[] = {1, 3};
  constexpr std::size_t kMinMatches = 12;
  std::vector<RotatedPair> pairs;
  for (const std::size_t stride : kStrides) {
    for (std::size_t end = stride; end < window.frames.size(); ++end) {
      RotatedPair pair{ImuPreintegration(window.frames[end].imu.noise()), {}};
      for (std::size_t i = end - stride + 1; i <= end; ++i) pair.imu.append(window.frames[i].imu);
      const std::int64_t first_id = window.frames[end - stride].id;
      const std::int64_t second_id = window.frames[end].id;
      for (const WindowTrack& track : window.tracks) {
        const WindowObservation* first = track.in(first_id);
        const WindowObservation* second = track.in(second_id);
        if (first == nullptr || second == nullptr) continue;
        pair.matches.push_back({first->bearing.homogeneous(), second->bearing.homogeneous(),
                                0.5 * (first->variance() + second->variance())});
      }
      if (pair.matches.size() >= kMinMatches) pairs.push_back(std::move(pair));
    }
  }
  return pairs;
}

struct BiasEquations {
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
};

// Adds a pair's epipolar residuals t . (a x R b); its translation direction t is eliminated.
void add_pair(RotatedPair& pair, const Eigen::Quaterniond& imu_from_camera,
              const Eigen::Vector3d& bias, bool is_robust, BiasEquations& out) {
  pair.imu.reintegrate(bias, Eigen::Vector3d::Zero());
  const Eigen::Matrix3d R_e = imu_from_camera.toRotationMatrix();
  const Eigen::Matrix3d camera_from_imu =
      R_e.transpose() * pair.imu.motion(bias, Eigen::Vector3d::Zero()).rotation.toRotationMatrix();
  const Eigen::Matrix3d by_bias = pair.imu.bias_jacobian().topLeftCorner<3, 3>();
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
  for (const BearingMatch& match : pair.matches) {
    const Eigen::Vector3d n = match.first.cross(camera_from_imu * (R_e * match.second));
    moment += n * n.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(moment);
  const Eigen::Vector3d t = eigen.eigenvectors().col(0);
  const Eigen::Matrix<double, 3, 2> tangent = eigen.eigenvectors().rightCols<2>();
  Eigen::Matrix2d D = Eigen::Matrix2d::Zero();
  Eigen::Matrix<double, 3, 2> C = Eigen::Matrix<double, 3, 2>::Zero();
  Eigen::Vector2d d = Eigen::Vector2d::Zero();
  for (const BearingMatch& match : pair.matches) {
    constexpr double kMinLever2 = 0.01;  // a bearing along the translation constrains nothing
    const Eigen::Vector3d second = R_e * match.second;
    const Eigen::Vector3d n = match.first.cross(camera_from_imu * second);
    const Eigen::Vector3d line = t.cross(match.first);
    const double variance = 2 * match.variance * std::max(kMinLever2, line.squaredNorm());
    const double r = t.dot(n);
    const Eigen::RowVector3d J = -line.transpose() * camera_from_imu * skew(second) * by_bias;
    const Eigen::RowVector2d K = n.transpose() * tangent;
    const double weight =
        (is_robust ? robust_weight(RobustKernel::geman_mcclure, r * r / variance).weight : 1) /
        variance;
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
}

}  // namespace

std::optional<Eigen::Vector3d> gyro_bias_from_images(const Window& window,
                                                     double prior_sigma_rad_s) {
  constexpr std::size_t kMinPairs = 3;
  constexpr int kIterations = 8;
  std::vector<RotatedPair> pairs = rotated_pairs(window);
  if (pairs.size() < kMinPairs) return std::nullopt;
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    BiasEquations equations;
    equations.H.diagonal().setConstant(1 / (prior_sigma_rad_s * prior_sigma_rad_s));
    equations.g = -equations.H * bias;
    for (RotatedPair& pair : pairs) {
      add_pair(pair, window.extrinsics.imu_from_camera.rotation, bias, iteration > 2, equations);
    }
    const Eigen::Vector3d step = equations.H.ldlt().solve(equations.g);
    if (!step.allFinite()) return std::nullopt;
    bias += step;
  }
  return bias;
}

}  // namespace stillkite
