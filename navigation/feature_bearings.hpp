#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "estimation/two_view/relative_pose.hpp"
#include "flow/feature_tracker.hpp"
#include "geometry/camera.hpp"
#include "navigation/window_flow.hpp"

namespace stillkite {

/// The features that were found, undistorted. `feature_of_pair[i]` is pair i's place in the tracks,
/// `covariance[i]` what the tracker says of its place now, on z = 1; empty where it says nothing.
struct FeatureBearings {
  std::vector<BearingPair> pairs;
  std::vector<std::size_t> feature_of_pair;
  std::vector<Eigen::Matrix2d> covariance;
};
[[nodiscard]] FeatureBearings feature_bearings(const Camera& camera, const FeatureTracks& tracks);

/// The inliers, where they are now, as features of this image.
[[nodiscard]] std::vector<cv::Point2f> followed_features(const FeatureTracks& tracks,
                                                         const FeatureBearings& bearings,
                                                         const std::vector<unsigned char>& inliers);

/// Up to `count` inliers spread over the reference: each next one as far from those chosen and at
/// hand as can be, none nearer than 0.02 on z = 1.
[[nodiscard]] std::vector<std::size_t> spread_pairs(const std::vector<BearingPair>& pairs,
                                                    const std::vector<unsigned char>& inliers,
                                                    const std::vector<Eigen::Vector2d>& at_hand,
                                                    std::size_t count);

/// The square that the inliers are off by from their epipolar lines, over what their covariances
/// say (geodesy's variance of unit weight): the mean of those within four sigma, each weighed by
/// its information, for it is the best that a pose hangs on. Nothing where less than 20 are told,
/// or there are no lines.
[[nodiscard]] std::optional<double> unit_variance(const FeatureBearings& bearings,
                                                  const RelativePoseEstimate& estimate);

/// Mean length of the found features' way from the reference to now, in the image.
[[nodiscard]] double mean_shift_px(const FeatureTracks& tracks);

/// Length of the way over the distance of what is seen, the mean over the inliers by least squares:
/// the angle by which a way across the view shifts them. 0 where there is no direction.
[[nodiscard]] double parallax_rad(const std::vector<BearingPair>& pairs,
                                  const RelativePoseEstimate& estimate);

/// The features' ways from the reference, to be drawn; outliers weigh nothing.
[[nodiscard]] std::vector<WindowFlow> drawn_features(const FeatureTracks& tracks,
                                                     const FeatureBearings& bearings,
                                                     const RelativePoseEstimate& estimate);

}  // namespace stillkite
