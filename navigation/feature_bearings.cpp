#include "navigation/feature_bearings.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <iterator>

namespace stillkite {
namespace {

// Of a feature from its epipolar line: squared, over its variance, and the inverse of that.
struct LineDistance {
  double squared;
  double information;
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
    const Eigen::Matrix2d by_px = distort(camera, *current).jacobian.inverse();
    bearings.covariance.emplace_back(by_px * tracks.covariance_px2[i].cast<double>() *
                                     by_px.transpose());
  }
  return bearings;
}

std::vector<cv::Point2f> followed_features(const FeatureTracks& tracks,
                                           const FeatureBearings& bearings,
                                           const std::vector<unsigned char>& inliers) {
  std::vector<cv::Point2f> followed_px;
  for (std::size_t i = 0; i < std::min(inliers.size(), bearings.pairs.size()); ++i) {
    if (inliers[i] == 0) continue;
    // a window's centre is half a pixel from its feature
    const Eigen::Vector2f& centre = tracks.current_px[bearings.feature_of_pair[i]];
    followed_px.emplace_back(centre.x() + 0.5F, centre.y() + 0.5F);
  }
  return followed_px;
}

std::vector<std::size_t> spread_pairs(const std::vector<BearingPair>& pairs,
                                      const std::vector<unsigned char>& inliers,
                                      const std::vector<Eigen::Vector2d>& at_hand,
                                      std::size_t count) {
  constexpr double kApart = 0.02;
  std::vector<std::size_t> chosen;
  std::vector<double> distance(std::min(pairs.size(), inliers.size()), 1e9);
  if (count == 0 || distance.empty()) return chosen;
  chosen.reserve(count);
  const auto keep_away = [&](const Eigen::Vector2d& from) {
    for (std::size_t i = 0; i < distance.size(); ++i) {
      distance[i] = std::min(distance[i], (pairs[i].reference - from).squaredNorm());
    }
  };
  for (std::size_t i = 0; i < distance.size(); ++i) {
    if (inliers[i] == 0) distance[i] = 0;
  }
  for (const Eigen::Vector2d& bearing : at_hand) keep_away(bearing);
  while (chosen.size() < count) {
    const auto farthest = std::max_element(distance.begin(), distance.end());
    if (!(*farthest > kApart * kApart)) break;
    chosen.push_back(static_cast<std::size_t>(farthest - distance.begin()));
    keep_away(pairs[chosen.back()].reference);
  }
  return chosen;
}

std::optional<double> unit_variance(const FeatureBearings& bearings,
                                    const RelativePoseEstimate& estimate) {
  constexpr std::size_t kFewest = 20;
  constexpr double kMedian = 0.4549;  // of chi-square with one degree of freedom
  constexpr double kStray = 16;       // four sigma
  const RelativePose& pose = estimate.epipolar;
  if (pose.direction.isZero()) return std::nullopt;
  std::vector<LineDistance> off;
  off.reserve(bearings.covariance.size());
  double information = 0;
  for (std::size_t i = 0; i < bearings.covariance.size() && i < estimate.inliers.size(); ++i) {
    if (estimate.inliers[i] == 0) continue;
    const BearingPair& pair = bearings.pairs[i];
    const Eigen::Vector3d line =
        pose.direction.cross(pose.current_from_reference * pair.reference.homogeneous());
    const double distance = line.dot(pair.current.homogeneous());
    const double variance = line.head<2>().dot(bearings.covariance[i] * line.head<2>());
    if (!(variance > 0)) continue;
    off.push_back({distance * distance / variance, line.head<2>().squaredNorm() / variance});
    information += off.back().information;
  }
  if (off.size() < kFewest) return std::nullopt;
  std::sort(off.begin(), off.end(),
            [](const LineDistance& a, const LineDistance& b) { return a.squared < b.squared; });
  auto middle = off.begin();
  for (double below = middle->information; 2 * below < information; ++middle) {
    below += std::next(middle)->information;
  }
  double sum = 0, weights = 0;
  for (const LineDistance& one : off) {
    if (one.squared > kStray * middle->squared / kMedian) break;
    sum += one.information * one.squared;
    weights += one.information;
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

// b ~ R a + r t with r = way / depth: b x R a + r b x t = 0 for every pair.
double parallax_rad(const std::vector<BearingPair>& pairs, const RelativePoseEstimate& estimate) {
  double product = 0;
  double square = 0;
  for (std::size_t i = 0; i < pairs.size() && i < estimate.inliers.size(); ++i) {
    if (estimate.inliers[i] == 0) continue;
    const Eigen::Vector3d b = pairs[i].current.homogeneous();
    const Eigen::Vector3d turned =
        estimate.pose.current_from_reference * pairs[i].reference.homogeneous();
    const Eigen::Vector3d across = b.cross(estimate.pose.direction);
    product -= b.cross(turned).dot(across);
    square += across.squaredNorm();
  }
  return square > 0 ? std::max(0.0, product / square) : 0;
}

std::vector<WindowFlow> drawn_features(const FeatureTracks& tracks, const FeatureBearings& bearings,
                                       const RelativePoseEstimate& estimate) {
  std::vector<WindowFlow> drawn;
  drawn.reserve(bearings.pairs.size());
  for (std::size_t i = 0; i < bearings.pairs.size(); ++i) {
    const std::size_t feature = bearings.feature_of_pair[i];
    const bool is_inlier = i < estimate.inliers.size() && estimate.inliers[i] != 0;
    drawn.push_back({.centre_px = tracks.current_px[feature],
                     .flow_px = tracks.current_px[feature] - tracks.reference_px[feature],
                     .weight = is_inlier ? 1.0F : 0.0F});
  }
  return drawn;
}

}  // namespace stillkite
