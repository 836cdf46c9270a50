#include "estimation/two_view/essential_decomposition.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>

namespace stillkite {
namespace {

struct CheiralityCount {
  int in_front_with_parallax = 0;
  int in_front_pairs = 0;
  int pairs_with_parallax = 0;
};

// Signs of the depths in b depth_b = depth_a R a + t, from the cross products with b and R a.
CheiralityCount count_cheirality(const RelativePose& pose, const BearingColumns& pairs,
                                 double min_angle_rad) {
  const Eigen::Matrix3d R = pose.current_from_reference.toRotationMatrix();
  CheiralityCount count;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Eigen::Vector3d a = R * Eigen::Vector3d(pairs.ax[i], pairs.ay[i], 1);
    const Eigen::Vector3d b(pairs.bx[i], pairs.by[i], 1);
    const Eigen::Vector3d normal = a.cross(b);
    const bool in_front =
        pose.direction.cross(b).dot(normal) < 0 && pose.direction.cross(a).dot(normal) < 0;
    const bool parallax =
        normal.squaredNorm() > min_angle_rad * min_angle_rad * a.squaredNorm() * b.squaredNorm();
    count.in_front_pairs += in_front ? 1 : 0;
    count.in_front_with_parallax += in_front && parallax ? 1 : 0;
    count.pairs_with_parallax += parallax ? 1 : 0;
  }
  return count;
}

}  // namespace

std::array<RelativePose, 4> decompose_essential(const Eigen::Matrix3d& E) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(E, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d U = svd.matrixU(), V = svd.matrixV();
  if (U.determinant() < 0) U = -U;
  if (V.determinant() < 0) V = -V;
  Eigen::Matrix3d W;
  W << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  const Eigen::Matrix3d first = U * W * V.transpose();
  const Eigen::Matrix3d second = U * W.transpose() * V.transpose();
  const Eigen::Vector3d t = U.col(2);
  const Eigen::Quaterniond p(first), q(second);
  return {{{p, t}, {p, -t}, {q, t}, {q, -t}}};
}

RelativePose select_by_cheirality(const Eigen::Matrix3d& E, const BearingColumns& pairs,
                                  double min_angle_rad) {
  const std::array<RelativePose, 4> poses = decompose_essential(E);
  const auto score = [&](const RelativePose& pose) {
    const CheiralityCount count = count_cheirality(pose, pairs, min_angle_rad);
    return count.pairs_with_parallax >= 5 ? count.in_front_with_parallax : count.in_front_pairs;
  };
  std::array<int, 4> scores{};
  std::transform(poses.begin(), poses.end(), scores.begin(), score);
  return poses[static_cast<std::size_t>(
      std::distance(scores.begin(), std::max_element(scores.begin(), scores.end())))];
}

}  // namespace stillkite
