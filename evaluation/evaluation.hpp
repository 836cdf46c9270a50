#pragma once

#include <optional>
#include <span>
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

/// What an estimator says about one moment, as far as it says it.
struct JudgedMotion {
  Timestamp stamp;
  RigidTransform world_from_body;
  bool is_metric = true;                     ///< false: its lengths are not metres
  std::optional<Twist> twist_in_camera;      ///< else the difference of neighbouring poses
  std::optional<Matrix6d> pose_covariance;   ///< (translation, rotation vector), both in world
  std::optional<Matrix6d> twist_covariance;  ///< (velocity, angular rate), in the camera
};

/// All of a run's frames; the first one's twist is left out, nothing was measured yet. Each is
/// metric by its own scale: an IMU tells metres midway, and not how high the flight began.
[[nodiscard]] std::vector<JudgedMotion> judged_motions(
    std::span<const NavigationEstimate> estimates);

/// Poses alone, as a trajectory file has them.
[[nodiscard]] std::vector<JudgedMotion> judged_motions(std::span<const StampedPose> poses);

/// The estimates that have a true pose.
[[nodiscard]] std::vector<PosePair> matched_poses(std::span<const JudgedMotion> estimates,
                                                  const Truth& truth, double tolerance_s);

struct EvaluationOptions {
  double tolerance_s = 0.01;  ///< between an estimate and the nearest truth
  Alignment alignment = Alignment::none;
  RigidTransform body_from_camera;
};

/// An estimate's errors. Nothing stands where nothing is known.
struct Evaluation {
  int matched = 0;
  double path_length_m = 0;             ///< of the truth, through the matched stamps
  std::optional<Similarity> alignment;  ///< nothing: it is not determined, no pose errors then
  std::optional<TrajectoryError> trajectory;
  std::optional<double> drift_percent;      ///< 100 x 3-D end error / path length
  std::optional<RelativeError> per_frame;   ///< relative error from one matched frame to the next
  std::optional<RelativeError> per_tenth;   ///< over a tenth of the path
  std::optional<VectorError> velocity;      ///< m/s, in the camera
  std::optional<VectorError> angular_rate;  ///< rad/s, in the camera
  std::optional<ReferenceError> reference;  ///< not by `evaluate`: of a run with such an estimator
  struct {
    std::optional<Consistency> position, attitude, velocity, angular_rate;
  } nees;
};

/// Velocities are compared half way between a frame and the one before it: with
/// `truth.twists_in_camera` where it has any, else with the difference of the true poses. Of an
/// estimate that is not metric only attitude and angular rate are judged.
[[nodiscard]] Evaluation evaluate(std::span<const JudgedMotion> estimates, const Truth& truth,
                                  const EvaluationOptions& options = {});

}  // namespace stillkite
