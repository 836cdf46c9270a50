#pragma once

#include <Eigen/Geometry>
#include <opencv2/core/types.hpp>
#include <optional>
#include <vector>

#include "estimation/two_view/relative_pose.hpp"
#include "flow/feature_tracks.hpp"
#include "geometry/camera.hpp"
#include "navigation/weighted_flow.hpp"

namespace stillkite {

/// Undistorted bearings of the associated features, on the plane z = 1.
struct FeatureBearings {
  std::vector<BearingPair> pairs;
  std::vector<std::size_t> feature_of_pair;  ///< index of each pair's feature in the tracks
  /// Measurement noise of each pair's current bearing; empty if the method estimates none.
  std::vector<Eigen::Matrix2d> covariance;
};
[[nodiscard]] FeatureBearings feature_bearings(const Camera& camera, const FeatureTracks& tracks);

/// Current positions of the inliers, px, as OpenCV features.
[[nodiscard]] std::vector<cv::Point2f> tracked_inliers(const FeatureTracks& tracks,
                                                       const FeatureBearings& bearings,
                                                       const std::vector<unsigned char>& inliers);

/// Indices of up to `count` inliers spread over the reference image: farthest-point sampling from
/// the selected and the `existing` bearings, at least 0.02 apart on z = 1.
[[nodiscard]] std::vector<std::size_t> select_spread_pairs(
    const std::vector<BearingPair>& pairs, const std::vector<unsigned char>& inliers,
    const std::vector<Eigen::Vector2d>& existing, std::size_t count);

/// Variance of unit weight (geodesy) of the inliers: squared epipolar distance over its variance,
/// averaged within four sigma and weighted by information. Empty for fewer than 20 pairs with a
/// covariance, or without a translation direction.
[[nodiscard]] std::optional<double> unit_variance(const FeatureBearings& bearings,
                                                  const RelativePoseEstimate& estimate);

/// Mean displacement of the associated features since the reference, px; 0 without features.
[[nodiscard]] double mean_shift_px(const FeatureTracks& tracks);

/// Ratio of translation to scene depth, least squares over the inliers: the mean parallax angle of
/// a translation across the view. 0 without a direction.
[[nodiscard]] double parallax_rad(const std::vector<BearingPair>& pairs,
                                  const RelativePoseEstimate& estimate);

/// Feature displacements since the reference, for drawing; weight 0 marks an outlier.
[[nodiscard]] std::vector<WeightedFlow> feature_flow_vectors(const FeatureTracks& tracks,
                                                             const FeatureBearings& bearings,
                                                             const RelativePoseEstimate& estimate);

}  // namespace stillkite
