#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "estimation/sliding_window/window.hpp"

namespace stillkite {

/// Feature in an image: number of its track, bearing on z = 1 with covariance.
struct FeatureObservation {
  std::int64_t track_id = 0;
  Eigen::Vector2d bearing = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
};

/// Bearing on z = 1 at which the estimate expects a track.
struct ExpectedFeature {
  std::int64_t track_id = 0;
  Eigen::Vector2d bearing = Eigen::Vector2d::Zero();
};

/// Adds the features of known tracks to the newest frame.
void add_observations(Window& window, std::span<const FeatureObservation> features);

/// Begins tracks in the newest frame with the features whose numbers are new.
void begin_tracks(Window& window, std::span<const FeatureObservation> features);

/// Replaces the observations of known tracks in the newest frame, or adds them.
void replace_observations(Window& window, std::span<const FeatureObservation> features);

/// Bearings of the points of a keyframe in the newest frame, by ascending number of the track, as
/// estimated; without those behind the camera.
[[nodiscard]] std::vector<ExpectedFeature> expected_features(const Window& window,
                                                             std::int64_t keyframe_id);

/// Points of the tracks that have none.
void triangulate_tracks(Window& window);

/// Number of the points that were measured in the newest frame, and those that fit the estimate.
struct MeasuredPoints {
  int measured = 0;
  int inliers = 0;
  double residual = 0;  ///< RMS of an inlier's component, on z = 1
};

/// Removes observations of more than four standard deviations, and points behind their camera.
MeasuredPoints reject_outliers(Window& window);

/// Removes observations before a track's first keyframe.
void restart_tracks(Window& window);

/// Removes tracks without observations, and those without a point that are not seen any more.
void remove_empty_tracks(Window& window);

/// Median depth of the points in their first keyframes; empty without points.
[[nodiscard]] std::optional<double> median_depth_m(const Window& window);

}  // namespace stillkite
