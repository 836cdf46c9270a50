#include "navigation/feature_bearings.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <iterator>

#include "geometry/chi_square.hpp"

namespace stillkite {
namespace {

// Distance of a feature from its epipolar line, over its variance.
struct LineDistance {
  double squared;
  double information;  // inverse variance, for weighting
};

}  // namespace

FeatureBearings feature_bearings(const Camera& camera, const FeatureTracks& tracks) {
  FeatureBearings bearings;
  bearings.pairs.reserve(tracks.found.size());
  for (std::size_t i = 0; i < tracks.found.size(); ++i) {
    if (tracks.found[i] == 0) continue;
    const auto reference = undistort(camera, tracks.reference_px[i].cast<double>());
    const auto current = undistort(camera, tracks.current_px[i].cast<double>());
    if (!reference || !current) continue;
    bearings.pairs.push_back({*reference, *current});
    bearings.feature_of_pair.push_back(i);
    if (tracks.covariance_px2.empty()) continue;
    const Eigen::Matrix2d jacobian_1_px = distort(camera, *current).jacobian.inverse();
    bearings.covariance.emplace_back(jacobian_1_px * tracks.covariance_px2[i].cast<double>() *
                                     jacobian_1_px.transpose());
  }
  return bearings;
}

std::vector<cv::Point2f> tracked_inliers(const FeatureTracks& tracks,
                                         const FeatureBearings& bearings,
                                         const std::vector<unsigned char>& inliers) {
  std::vector<cv::Point2f> tracked_px;
  for (std::size_t i = 0; i < std::min(inliers.size(), bearings.pairs.size()); ++i) {
    if (inliers[i] == 0) continue;
    // a patch's centre is half a pixel from its feature
    const Eigen::Vector2f& centre = tracks.current_px[bearings.feature_of_pair[i]];
    tracked_px.emplace_back(centre.x() + 0.5F, centre.y() + 0.5F);
  }
  return tracked_px;
}

std::vector<std::size_t> select_spread_pairs(const std::vector<BearingPair>& pairs,
                                             const std::vector<unsigned char>& inliers,
                                             const std::vector<Eigen::Vector2d>& existing,
                                             std::size_t count) {
  constexpr double kMinSeparation = 0.02;
  std::vector<std::size_t> selected;
  std::vector<double> distance(std::min(pairs.size(), inliers.size()), 1e9);
  if (count == 0 || distance.empty()) return selected;
  selected.reserve(count);
  const auto update_distances = [&](const Eigen::Vector2d& from) {
    for (std::size_t i = 0; i < distance.size(); ++i) {
      distance[i] = std::min(distance[i], (pairs[i].reference - from).squaredNorm());
    }
  };
  for (std::size_t i = 0; i < distance.size(); ++i) {
    if (inliers[i] == 0) distance[i] = 0;
  }
  for (const Eigen::Vector2d& bearing : existing) update_distances(bearing);
  while (selected.size() < count) {
    const auto farthest = std::max_element(distance.begin(), distance.end());
    if (!(*farthest > kMinSeparation * kMinSeparation)) break;
    selected.push_back(static_cast<std::size_t>(farthest - distance.begin()));
    update_distances(pairs[selected.back()].reference);
  }
  return selected;
}

std::optional<double> unit_variance(const FeatureBearings& bearings,
                                    const RelativePoseEstimate& estimate) {
  constexpr std::size_t kMinPairs = 20;
  constexpr double kMaxSquaredError = 16;  // four sigma
  const RelativePose& pose = estimate.epipolar;
  if (pose.direction.isZero()) return std::nullopt;
  std::vector<LineDistance> distances;
  distances.reserve(bearings.covariance.size());
  double information = 0;
  for (std::size_t i = 0; i < bearings.covariance.size() && i < estimate.inliers.size(); ++i) {
    if (estimate.inliers[i] == 0) continue;
    const BearingPair& pair = bearings.pairs[i];
    const Eigen::Vector3d line =
        pose.direction.cross(pose.current_from_reference * pair.reference.homogeneous());
    const double distance = line.dot(pair.current.homogeneous());
    const double variance = line.head<2>().dot(bearings.covariance[i] * line.head<2>());
    if (!(variance > 0)) continue;
    distances.push_back({distance * distance / variance, line.head<2>().squaredNorm() / variance});
    information += distances.back().information;
  }
  if (distances.size() < kMinPairs) return std::nullopt;
  std::sort(distances.begin(), distances.end(),
            [](const LineDistance& a, const LineDistance& b) { return a.squared < b.squared; });
  auto median = distances.begin();
  for (double below = median->information; 2 * below < information; ++median) {
    below += std::next(median)->information;
  }
  double sum = 0, weights = 0;
  for (const LineDistance& distance : distances) {
    if (distance.squared > kMaxSquaredError * median->squared / kChiSquareMedian1) break;
    sum += distance.information * distance.squared;
    weights += distance.information;
  }
  return sum / weights;
}

double mean_shift_px(const FeatureTracks& tracks) {
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < tracks.found.size(); ++i) {
    if (tracks.found[i] == 0) continue;
    sum += (tracks.current_px[i] - tracks.reference_px[i]).norm();
    ++count;
  }
  return count == 0 ? 0 : sum / count;
}

// b ~ R a + r t with r = translation / depth: b x R a + r b x t = 0 for every pair.
double parallax_rad(const std::vector<BearingPair>& pairs, const RelativePoseEstimate& estimate) {
  double product = 0;
  double square = 0;
  for (std::size_t i = 0; i < pairs.size() && i < estimate.inliers.size(); ++i) {
    if (estimate.inliers[i] == 0) continue;
    const Eigen::Vector3d b = pairs[i].current.homogeneous();
    const Eigen::Vector3d rotated =
        estimate.pose.current_from_reference * pairs[i].reference.homogeneous();
    const Eigen::Vector3d across = b.cross(estimate.pose.direction);
    product -= b.cross(rotated).dot(across);
    square += across.squaredNorm();
  }
  return square > 0 ? std::max(0.0, product / square) : 0;
}

std::vector<WeightedFlow> feature_flow_vectors(const FeatureTracks& tracks,
                                               const FeatureBearings& bearings,
                                               const RelativePoseEstimate& estimate) {
  std::vector<WeightedFlow> vectors;
  vectors.reserve(bearings.pairs.size());
  for (std::size_t i = 0; i < bearings.pairs.size(); ++i) {
    const std::size_t feature = bearings.feature_of_pair[i];
    const bool is_inlier = i < estimate.inliers.size() && estimate.inliers[i] != 0;
    vectors.push_back({.centre_px = tracks.current_px[feature],
                       .flow_px = tracks.current_px[feature] - tracks.reference_px[feature],
                       .weight = is_inlier ? 1.0F : 0.0F});
  }
  return vectors;
}

}  // namespace stillkite
