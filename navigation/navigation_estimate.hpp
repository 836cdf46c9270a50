#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>

#include "estimation/motion_estimate.hpp"
#include "estimation/twist.hpp"
#include "estimation/two_view/relative_pose.hpp"
#include "estimation/verdict.hpp"
#include "geometry/rigid_transform.hpp"
#include "geometry/time.hpp"

namespace stillkite {

/// Agreement of one frame's flow vectors (of tiles, a dense field or features) with one motion.
struct FlowQuality {
  int flow_vectors = 0;     ///< number with texture
  double inlier_ratio = 0;  ///< 0..1, explained by the motion
  double mean_flow_px = 0;  ///< mean length, since the keyframe or reference if there is one
  double residual_px = 0;   ///< robust standard deviation of flow minus motion
  double condition = 0;     ///< condition number of the scaled normal matrix, >= 1; 0: not solved
};

/// Processing stages of a frame, for timing.
enum class Stage { pyramid, flow, solve, filter };
inline constexpr int kStageCount = 4;

template <>
struct EnumNames<Stage> {
  static constexpr auto value =
      std::to_array<std::pair<Stage, std::string_view>>({{Stage::pyramid, "pyramid"},
                                                         {Stage::flow, "flow"},
                                                         {Stage::solve, "solve"},
                                                         {Stage::filter, "filter"}});
};

/// Result of the reference estimator for one frame.
struct ReferenceReport {
  MotionEstimate motion;           ///< since the reference frame; of the fusion once that is metric
  Timestamp reference_stamp;       ///< of the current reference frame
  bool on_first_reference = true;  ///< false: only rotation is chained to the first reference
  bool new_reference = false;      ///< this frame becomes the reference
  bool relocalized = false;        ///< the first reference was matched again in this frame
  ViewModel model = ViewModel::undecided;
  int features = 0;        ///< number of associated reference features
  int inliers = 0;         ///< number explained by the model
  double residual_px = 0;  ///< robust standard deviation of the inliers' residuals
  /// Mean angular rate since the previous frame, by images alone; empty: not measured.
  std::optional<Eigen::Vector3d> measured_rate_in_camera_rad_s;
};

/// Gravity alignment of a world that is fixed by the initial attitude as it was given.
struct GravityAlignment {
  /// Smallest rotation that makes z vertical, about the initial camera position.
  RigidTransform aligned_from_world;
  Matrix6d pose_covariance = Matrix6d::Zero();  ///< of the aligned pose, aligned axes
  double sigma_rad = 0;  ///< of the vertical, about the less certain horizontal axis
};

/// State at a frame's stamp. W world (z up), B body, C camera (docs/notation.md). Lengths are in
/// metres; without a scale source they are in initial heights above the ground.
struct NavigationEstimate {
  Timestamp stamp;
  std::int64_t frame_index = 0;
  Verdict verdict = Verdict::first_frame;
  EstimateSource source = EstimateSource::flow;

  RigidTransform world_from_body;
  RigidTransform world_from_initial;  ///< body pose at the first frame, rescaled with the world
  Matrix6d pose_covariance = Matrix6d::Zero();  ///< (translation, rotation vector), both in W
  /// Alignment if the world keeps the given initial attitude (fused, best); empty: z is vertical.
  std::optional<GravityAlignment> gravity_alignment;

  Twist twist_in_camera;  ///< filtered; with keyframes the interval's mean, in C at mid-interval
  Matrix6d twist_covariance = Matrix6d::Zero();  ///< (velocity, angular rate), both in C
  std::optional<Twist> measured_twist;           ///< least squares before the filter (paper mode)
  Eigen::Vector3d velocity_in_world_m_s = Eigen::Vector3d::Zero();
  /// Mean angular rate since the previous frame, by images alone (policy flow); empty: not
  /// measured.
  std::optional<Eigen::Vector3d> measured_rate_in_camera_rad_s;
  /// Mean flow vector of the ground since the last image that was not frozen; empty: not measured.
  std::optional<Eigen::Vector2d> image_shift_px;

  double masked_ratio = 0;  ///< of the image, by the frame's mask and detected static overlays

  ScaleSource scale = ScaleSource::none;
  double scale_age_s = 0;  ///< since the last reading of that source
  bool new_keyframe = false;
  bool relocalized = false;  ///< policy fused, window: position and yaw by the reference keyframe
  FlowQuality quality;
  std::optional<ReferenceReport> reference;    ///< empty if the reference estimator does not run
  std::array<double, kStageCount> stage_ms{};  ///< wall time, by Stage
};

/// True if the lengths are in initial heights: those of the flow without a scale source.
[[nodiscard]] inline bool is_in_heights(const NavigationEstimate& estimate) {
  return estimate.scale == ScaleSource::none && estimate.source == EstimateSource::flow;
}

/// Estimate with poses, pose covariance and velocity in the gravity-aligned world. Returned
/// unchanged if `gravity_alignment` is empty.
[[nodiscard]] inline NavigationEstimate gravity_aligned(NavigationEstimate estimate) {
  if (!estimate.gravity_alignment) return estimate;
  const RigidTransform& aligned_from_world = estimate.gravity_alignment->aligned_from_world;
  estimate.world_from_body = aligned_from_world * estimate.world_from_body;
  estimate.world_from_initial = aligned_from_world * estimate.world_from_initial;
  estimate.velocity_in_world_m_s = aligned_from_world.rotation * estimate.velocity_in_world_m_s;
  estimate.pose_covariance = estimate.gravity_alignment->pose_covariance;
  estimate.gravity_alignment.reset();
  return estimate;
}

}  // namespace stillkite
