#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

#include "estimation/fusion/fusion_config.hpp"
#include "estimation/fusion/landmark_view.hpp"

namespace stillkite {

class FusionFilter;

/// What a filter was told of a frame, from `FusionFilter::begin_step` on.
struct ToldFrame {
  using Tell = std::function<void(FusionFilter&)>;
  std::vector<Tell> before_views;
  std::vector<FeatureView> seen;  ///< empty where the landmarks corrected nothing
  std::vector<Tell> after_views;
};

/// Errors of a pose: rotation and position, world axes.
inline constexpr Eigen::Index kPose = 6;

/// The camera's poses through a start, by all that was told but the landmarks.
struct StartPrior {
  std::vector<RigidTransform> world_from_camera;  ///< a frame each, map units
  /// Of the errors of all frames' poses, if the anchor's is where it is said to be, with those of
  /// the chosen frames.
  Eigen::MatrixXd covariance;
};

/// Where a frame's errors begin.
[[nodiscard]] inline Eigen::Index pose_at(std::size_t frame) {
  return kPose * static_cast<Eigen::Index>(frame);
}

/// Of a filter without landmarks, smoothed (Rauch, Tung, Striebel 1965).
[[nodiscard]] StartPrior start_prior(const FusionConfig& config, const FusionStart& start,
                                     std::span<const ToldFrame> frames, std::size_t anchor,
                                     std::span<const std::size_t> chosen);

}  // namespace stillkite
