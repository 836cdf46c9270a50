#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "estimation/twist.hpp"
#include "evaluation/alignment.hpp"
#include "evaluation/association.hpp"
#include "evaluation/consistency.hpp"
#include "evaluation/reference_error.hpp"
#include "evaluation/trajectory_error.hpp"
#include "evaluation/vector_error.hpp"
#include "navigation/navigation_estimate.hpp"

namespace stillkite {

/// Diagonal blocks of a 6x6 covariance.
struct BlockCovariance {
  template <typename Derived>
  // NOLINTNEXTLINE(google-explicit-constructor): replaces the matrix
  BlockCovariance(const Eigen::MatrixBase<Derived>& P)
      : linear(P.template topLeftCorner<3, 3>()), angular(P.template bottomRightCorner<3, 3>()) {}

  Eigen::Matrix3d linear, angular;
};

/// Estimate of one frame under evaluation.
struct EvaluatedMotion {
  Timestamp stamp;
  RigidTransform world_from_body;
  bool is_metric = true;                            ///< false: no metric scale
  bool has_attitude = true;                         ///< false: only the position is known
  std::optional<Twist> twist_in_camera;             ///< else differenced from neighbouring poses
  std::optional<BlockCovariance> pose_covariance;   ///< (translation, rotation vector), in world
  std::optional<BlockCovariance> twist_covariance;  ///< (velocity, angular rate), in the camera
};

/// Frame of a run; the first frame has no twist. `is_metric` from its scale source; false for
/// `none` and `imu`: the IMU scale converges in flight, without the initial height.
[[nodiscard]] EvaluatedMotion evaluated_motion(const NavigationEstimate& estimate);
[[nodiscard]] std::vector<EvaluatedMotion> evaluated_motions(
    std::span<const NavigationEstimate> estimates);

/// Poses without twists and covariances, as in a trajectory file.
[[nodiscard]] std::vector<EvaluatedMotion> evaluated_motions(std::span<const StampedPose> poses,
                                                             bool has_attitude = true);

/// True if the attitude is the same in every row of the truth while the estimate turns by more than
/// 20 degrees: either the truth has none, or the estimate is wrong. It is judged as it is.
[[nodiscard]] bool contradicts_constant_attitude(std::span<const EvaluatedMotion> estimates,
                                                 std::span<const StampedPose> truth);
inline constexpr std::string_view kConstantAttitude =
    "truth: the attitude is the same in every row while the estimate turns by more than 20 "
    "degrees. "
    "If it is unknown, set it to the identity or give positions alone (truth.positions)";

/// Estimates with a true pose. If one of the two has no attitude, it gets the other's.
[[nodiscard]] std::vector<PosePair> matched_poses(std::span<const EvaluatedMotion> estimates,
                                                  const Truth& truth, double tolerance_s);

struct EvaluationOptions {
  double tolerance_s = 0.01;  ///< maximum time difference of an estimate to the nearest truth
  Alignment alignment = Alignment::none;
  RigidTransform body_from_camera;
};

/// Errors of an estimate. An optional is empty if estimate or truth lacks the quantity.
struct Evaluation {
  int matched = 0;  ///< estimates with a true pose; without any, those with a true velocity
  std::optional<double> path_length_m;  ///< length of the true path through the matched stamps
  std::optional<Similarity> alignment;  ///< empty if underdetermined: then no pose errors
  std::optional<TrajectoryError> trajectory;
  std::optional<double> drift_percent;      ///< 100 x 3-D end error / path length
  std::optional<double> rmse_percent;       ///< 100 x position RMSE / path length
  std::optional<RelativeError> per_frame;   ///< between consecutive matched frames
  std::optional<RelativeError> per_metre;   ///< over 1 m of the path
  std::optional<RelativeError> per_tenth;   ///< over 10 % of the path
  std::optional<VectorError> velocity;      ///< m/s, in the camera
  std::optional<VectorError> angular_rate;  ///< rad/s, in the camera
  std::optional<ReferenceError> reference;  ///< not set by `evaluate`
  struct {
    std::optional<Consistency> position, attitude, velocity, angular_rate;
  } nees;  ///< the covariances include the truth's own error
};

/// Velocities are compared half way between a frame and the one before it, to
/// `truth.twists_in_camera` if not empty, else to `truth.velocities` (each row once), else to
/// differenced true poses. Non-metric estimates contribute attitude and angular rate only. Truth or
/// estimate without attitude leaves attitude and angular rate empty.
[[nodiscard]] Evaluation evaluate(std::span<const EvaluatedMotion> estimates, const Truth& truth,
                                  const EvaluationOptions& options = {});

}  // namespace stillkite
