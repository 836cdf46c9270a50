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

/// How well the windows of one frame agreed.
struct FlowQuality {
  int windows = 0;          ///< windows that carried information
  double inlier_ratio = 0;  ///< of them, the share that the one motion explains
  double mean_flow_px = 0;  ///< mean length, since the keyframe or reference if there is one
  double residual_px = 0;   ///< robust standard deviation of flow minus motion
  double condition = 0;     ///< of the least squares' scaled normal matrix, >= 1
};

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

/// What the reference estimator says of one frame.
struct ReferenceReport {
  MotionEstimate motion;      ///< from the reference frame at hand; the fusion's, once in metres
  Timestamp reference_stamp;  ///< of that frame
  bool on_first_reference = true;  ///< it is the first one; else only rotation leads further back
  bool new_reference = false;      ///< this frame is the reference from now on
  bool relocalized = false;        ///< the first one was found again, in this frame
  ViewModel model = ViewModel::undecided;
  int features = 0;        ///< of the reference, found again
  int inliers = 0;         ///< of them, those that the model explains
  double residual_px = 0;  ///< robust standard deviation of the inliers from it
  /// Mean since the frame before, by the images alone.
  std::optional<Eigen::Vector3d> seen_rate_in_camera_rad_s;
};

/// What is upright where the world is that of the first frame, whose pose stays as it was given.
struct GravityAlignment {
  RigidTransform aligned_from_world;  ///< by the least turn, about the camera's place at the start
  Matrix6d pose_covariance = Matrix6d::Zero();  ///< of the pose there, in its axes
  double sigma_rad = 0;  ///< of the vertical, about the axis of which less is known
};

/// What one frame tells: the state at its stamp. Without any height (`scale` is none) every metre
/// below is one initial height over the ground.
struct NavigationEstimate {
  Timestamp stamp;
  std::int64_t frame_index = 0;
  Verdict verdict = Verdict::first_frame;
  EstimateSource source = EstimateSource::flow;

  RigidTransform world_from_body;
  RigidTransform world_from_start;  ///< the same at the first frame, in metres once there are any
  Matrix6d pose_covariance = Matrix6d::Zero();  ///< (translation, rotation vector), both in world

  std::optional<GravityAlignment> upright;  ///< where the world itself need not be

  Twist twist_in_camera;  ///< filtered; with keyframes the mean over the interval, half way
  Matrix6d twist_covariance = Matrix6d::Zero();  ///< (velocity, angular rate)
  std::optional<Twist> measured_twist;           ///< this frame's least squares, before the filter
  Eigen::Vector3d velocity_in_world_m_s = Eigen::Vector3d::Zero();
  /// Of the ground, since the last image that was not frozen but over the last interval; 0: not
  /// measured.
  double image_speed_px_s = 0;
  /// Of the ground, mean, since that image; nothing where it was not measured.
  std::optional<Eigen::Vector2d> image_shift_px;

  double hidden_ratio = 0;  ///< of the image: by its mask, and what was found to be fixed to it

  ScaleSource scale = ScaleSource::none;
  double scale_age_s = 0;  ///< since the last reading of that source
  bool new_keyframe = false;
  FlowQuality quality;
  std::optional<ReferenceReport> reference;    ///< where the reference estimator ran
  std::array<double, kStageCount> stage_ms{};  ///< by Stage
};

/// The same in a world whose z is up: poses, covariance and velocity turned as `upright` has it;
/// one whose world is upright by itself stays as it is.
[[nodiscard]] inline NavigationEstimate gravity_aligned(NavigationEstimate estimate) {
  if (!estimate.upright) return estimate;
  const RigidTransform& aligned_from_world = estimate.upright->aligned_from_world;
  estimate.world_from_body = aligned_from_world * estimate.world_from_body;
  estimate.world_from_start = aligned_from_world * estimate.world_from_start;
  estimate.velocity_in_world_m_s = aligned_from_world.rotation * estimate.velocity_in_world_m_s;
  estimate.pose_covariance = estimate.upright->pose_covariance;
  estimate.upright.reset();
  return estimate;
}

}  // namespace stillkite
