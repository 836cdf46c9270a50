#include "estimation/two_view/ground_relief.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/median.hpp"

namespace stillkite {
namespace {

constexpr std::size_t kMinFeatures = 20;
constexpr double kMinParallax_sigmas = 5;

// Parallax r = s / Z of a feature and n.a of flat ground at h = s, both scaled by the image length
// of a unit parallax, so that their noise is that of a coordinate.
struct FeatureParallax {
  double parallax;
  double flat_ground;
};

// b ~ R a + r t: b x R a + r b x t = 0.
std::vector<FeatureParallax> feature_parallaxes(const std::vector<BearingPair>& pairs,
                                                const std::vector<unsigned char>& inliers,
                                                const RelativePose& pose,
                                                const Eigen::Vector3d& normal) {
  std::vector<FeatureParallax> features;
  features.reserve(pairs.size());
  for (std::size_t i = 0; i < std::min(pairs.size(), inliers.size()); ++i) {
    if (inliers[i] == 0) continue;
    const Eigen::Vector3d a = pairs[i].reference.homogeneous();
    const Eigen::Vector3d b = pairs[i].current.homogeneous();
    const Eigen::Vector3d across = b.cross(pose.direction);
    const double length = across.norm();
    if (!(length > 1e-6)) continue;  // no parallax at the epipole
    const double parallax = -b.cross(pose.current_from_reference * a).dot(across) / length;
    features.push_back({parallax, length * std::max(0.0, normal.dot(a))});
  }
  return features;
}

// s / h: median over the features below the horizon.
std::optional<double> baseline_over_height(const std::vector<FeatureParallax>& features) {
  std::vector<double> ratios;
  ratios.reserve(features.size());
  for (const FeatureParallax& feature : features) {
    if (feature.flat_ground > 1e-3) ratios.push_back(feature.parallax / feature.flat_ground);
  }
  if (ratios.size() < kMinFeatures) return std::nullopt;
  return upper_median(ratios);
}

// 1000 if the predicted point is behind the camera.
double reprojection_error(const Eigen::Vector2d& measured, const Eigen::Vector3d& predicted) {
  return predicted.z() > 1e-6 ? (measured - predicted.hnormalized()).norm() : 1e3;
}

}  // namespace

std::optional<double> ground_relief(const std::vector<BearingPair>& pairs,
                                    const std::vector<unsigned char>& inliers,
                                    const RelativePose& pose,
                                    const Eigen::Vector3d& normal_in_reference, double sigma) {
  if (pose.direction.isZero()) return std::nullopt;
  const std::vector<FeatureParallax> features =
      feature_parallaxes(pairs, inliers, pose, normal_in_reference);
  if (features.size() < kMinFeatures) return std::nullopt;
  const double ratio = baseline_over_height(features).value_or(0);  // 0: no ground in view
  std::vector<double> parallaxes;
  std::vector<double> residuals;
  parallaxes.reserve(features.size());
  residuals.reserve(features.size());
  for (const FeatureParallax& feature : features) {
    parallaxes.push_back(std::abs(feature.parallax));
    residuals.push_back(std::abs(feature.parallax - ratio * feature.flat_ground));
  }
  const double parallax = upper_median(parallaxes);
  if (!(parallax > kMinParallax_sigmas * sigma)) return std::nullopt;
  return upper_median(residuals) / parallax;
}

std::optional<double> ground_misfit(const std::vector<BearingPair>& pairs,
                                    const RigidTransform& current_from_reference,
                                    const Eigen::Vector3d& normal_in_reference, double height,
                                    double sigma) {
  if (pairs.size() < kMinFeatures || !(height > 0)) return std::nullopt;
  std::vector<double> rotation_residuals;
  std::vector<double> homography_residuals;
  rotation_residuals.reserve(pairs.size());
  homography_residuals.reserve(pairs.size());
  for (const BearingPair& pair : pairs) {
    const Eigen::Vector3d a = pair.reference.homogeneous();
    const double inverse_depth = std::max(0.0, normal_in_reference.dot(a)) / height;
    const Eigen::Vector3d rotated_a = current_from_reference.rotation * a;
    rotation_residuals.push_back(reprojection_error(pair.current, rotated_a));
    homography_residuals.push_back(reprojection_error(
        pair.current, rotated_a + inverse_depth * current_from_reference.translation));
  }
  const double parallax = upper_median(rotation_residuals);
  if (!(parallax > kMinParallax_sigmas * sigma)) return std::nullopt;
  return upper_median(homography_residuals) / parallax;
}

}  // namespace stillkite
