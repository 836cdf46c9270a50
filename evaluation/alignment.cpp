#include "evaluation/alignment.hpp"

#include <Eigen/SVD>
#include <cmath>

namespace stillkite {
namespace {

/// Moments of the positions: centroids, cross covariance (truth, estimate), variances.
struct Moments {
  Eigen::Vector3d estimate_mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d truth_mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();
  double estimate_variance = 0;
  double truth_variance = 0;
};

Moments moments(std::span<const PosePair> pairs) {
  Moments m;
  const double n = static_cast<double>(pairs.size());
  for (const PosePair& pair : pairs) {
    m.estimate_mean += pair.estimate.translation / n;
    m.truth_mean += pair.truth.translation / n;
  }
  for (const PosePair& pair : pairs) {
    const Eigen::Vector3d x = pair.estimate.translation - m.estimate_mean;
    const Eigen::Vector3d y = pair.truth.translation - m.truth_mean;
    m.cross += y * x.transpose() / n;
    m.estimate_variance += x.squaredNorm() / n;
    m.truth_variance += y.squaredNorm() / n;
  }
  return m;
}

/// Minimum extent over the largest singular value, or over the distance from the origin; smaller
/// values are rounding errors.
constexpr double kMinRelativeExtent = 1e-9;

/// Constant positions determine neither rotation nor scale.
bool have_extent(const Moments& m) {
  return std::sqrt(m.estimate_variance) > kMinRelativeExtent * m.estimate_mean.norm() &&
         std::sqrt(m.truth_variance) > kMinRelativeExtent * m.truth_mean.norm();
}

std::optional<Similarity> umeyama(const Moments& m, bool with_scale) {
  if (!have_extent(m)) return std::nullopt;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m.cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d& d = svd.singularValues();
  if (!(d(1) > kMinRelativeExtent * d(0))) return std::nullopt;
  Eigen::Vector3d s = Eigen::Vector3d::Ones();
  if ((svd.matrixU() * svd.matrixV()).determinant() < 0) s(2) = -1;
  const Eigen::Matrix3d R = svd.matrixU() * s.asDiagonal() * svd.matrixV().transpose();
  const double scale = with_scale ? d.dot(s) / m.estimate_variance : 1.0;
  return Similarity{.scale = scale,
                    .rigid = {.rotation = Eigen::Quaterniond(R),
                              .translation = m.truth_mean - scale * (R * m.estimate_mean)}};
}

std::optional<Similarity> yaw_alignment(const Moments& m) {
  if (!have_extent(m)) return std::nullopt;
  const double sine = m.cross(1, 0) - m.cross(0, 1);
  const double cosine = m.cross(0, 0) + m.cross(1, 1);
  if (!(std::hypot(sine, cosine) > kMinRelativeExtent * m.estimate_variance)) return std::nullopt;
  const Eigen::Quaterniond rotation(
      Eigen::AngleAxisd(std::atan2(sine, cosine), Eigen::Vector3d::UnitZ()));
  return Similarity{
      .rigid = {.rotation = rotation, .translation = m.truth_mean - rotation * m.estimate_mean}};
}

}  // namespace

std::optional<Similarity> best_alignment(std::span<const PosePair> pairs, Alignment alignment) {
  if (pairs.empty()) return std::nullopt;
  switch (alignment) {
    case Alignment::none:
      break;
    case Alignment::origin:
      return Similarity{.rigid = pairs.front().truth * pairs.front().estimate.inverse()};
    case Alignment::yaw:
      return yaw_alignment(moments(pairs));
    case Alignment::se3:
      return umeyama(moments(pairs), false);
    case Alignment::sim3:
      return umeyama(moments(pairs), true);
  }
  return Similarity{};
}

RigidTransform apply(const Similarity& similarity, const RigidTransform& world_from_body) {
  return {.rotation = similarity.rigid.rotation * world_from_body.rotation,
          .translation = similarity.rigid * (similarity.scale * world_from_body.translation)};
}

std::vector<PosePair> aligned(std::span<const PosePair> pairs, const Similarity& similarity) {
  std::vector<PosePair> result(pairs.begin(), pairs.end());
  for (PosePair& pair : result) pair.estimate = apply(similarity, pair.estimate);
  return result;
}

}  // namespace stillkite
