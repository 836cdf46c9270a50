#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "estimation/sliding_window/window.hpp"
#include "estimation/sliding_window/window_tracks.hpp"

namespace stillkite {

/// Points of a keyframe that has left the window, to find the camera by them again.
struct KeyframeMap {
  struct Point {
    std::int64_t track_id = 0;
    InverseDepthPoint point;         ///< in the keyframe's camera
    double inverse_depth_sigma = 0;  ///< 1/m
  };
  RigidTransform world_from_camera;
  std::vector<Point> points;  ///< by ascending number of the track
};

/// Points of a keyframe that other images have measured. Empty if it is not in the window.
[[nodiscard]] KeyframeMap keyframe_map(const Window& window, std::int64_t keyframe_id);

/// Camera in the axes of the map's keyframe.
struct CameraInMap {
  RigidTransform keyframe_from_camera;
  Matrix6d covariance;  ///< rotation in camera axes, then position
  int inliers = 0;      ///< within four standard deviations
};

/// Camera pose from features of the map: Levenberg-Marquardt from `guess`, Huber's loss, then
/// without outliers. Empty if fewer than 20 features, or less than half of them, agree.
[[nodiscard]] std::optional<CameraInMap> locate_camera(const KeyframeMap& map,
                                                       std::span<const FeatureObservation> features,
                                                       const RigidTransform& guess);

}  // namespace stillkite
