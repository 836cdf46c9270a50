#include "evaluation/evaluation.hpp"

#include <cmath>

#include "evaluation/twist_pairs.hpp"

namespace stillkite {
namespace {

bool is_comparable(const TwistPair& pair, Eigen::Vector3d Twist::*part) {
  return pair.is_metric || part == &Twist::angular_rate_rad_s;
}

std::optional<VectorError> twist_error(std::span<const TwistPair> pairs,
                                       Eigen::Vector3d Twist::*part) {
  std::vector<Eigen::Vector3d> estimate;
  std::vector<Eigen::Vector3d> truth;
  for (const TwistPair& pair : pairs) {
    if (!is_comparable(pair, part)) continue;
    estimate.push_back(pair.estimate.*part);
    truth.push_back(pair.truth.*part);
  }
  return vector_error(estimate, truth);
}

std::optional<Consistency> twist_consistency(std::span<const EvaluatedMotion> estimates,
                                             std::span<const TwistPair> pairs,
                                             Eigen::Vector3d Twist::*part, Eigen::Index offset) {
  std::vector<double> samples;
  for (const TwistPair& pair : pairs) {
    const std::optional<Matrix6d>& P = estimates[pair.index].twist_covariance;
    if (!P || !is_comparable(pair, part)) continue;
    const Eigen::Matrix3d block = P->block<3, 3>(offset, offset);
    const auto value = nees(pair.estimate.*part - pair.truth.*part, block);
    if (value) samples.push_back(*value);
  }
  return consistency(samples, 3);
}

struct PoseNees {
  std::vector<double> position, attitude;
};

PoseNees pose_nees(std::span<const EvaluatedMotion> estimates, std::span<const PosePair> pairs) {
  PoseNees samples;
  for (const PosePair& pair : pairs) {
    const auto& P = estimates[pair.index].pose_covariance;
    if (!P) continue;
    const auto position =
        nees(pair.estimate.translation - pair.truth.translation, P->topLeftCorner<3, 3>());
    const auto attitude = nees(so3_log(pair.estimate.rotation * pair.truth.rotation.conjugate()),
                               P->bottomRightCorner<3, 3>());
    if (position && pair.is_metric) samples.position.push_back(*position);
    if (attitude) samples.attitude.push_back(*attitude);
  }
  return samples;
}

std::optional<double> drift_percent(const std::optional<PositionError>& error,
                                    double path_length_m) {
  if (!error || !error->end || !(path_length_m > 0)) return std::nullopt;
  return 100 * std::hypot(error->end->horizontal_m, error->end->vertical_m) / path_length_m;
}

bool is_metric_source(ScaleSource scale) {
  return scale != ScaleSource::none && scale != ScaleSource::imu;
}

}  // namespace

std::vector<EvaluatedMotion> evaluated_motions(std::span<const NavigationEstimate> estimates) {
  std::vector<EvaluatedMotion> result;
  result.reserve(estimates.size());
  for (const NavigationEstimate& estimate : estimates) {
    EvaluatedMotion motion{.stamp = estimate.stamp,
                           .world_from_body = estimate.world_from_body,
                           .is_metric = is_metric_source(estimate.scale),
                           .pose_covariance = estimate.pose_covariance};
    if (estimate.verdict != Verdict::first_frame) {
      motion.twist_in_camera = estimate.twist_in_camera;
      motion.twist_covariance = estimate.twist_covariance;
    }
    result.push_back(motion);
  }
  return result;
}

std::vector<PosePair> matched_poses(std::span<const EvaluatedMotion> estimates, const Truth& truth,
                                    double tolerance_s) {
  std::vector<StampedPose> poses;
  poses.reserve(estimates.size());
  for (const EvaluatedMotion& estimate : estimates) {
    poses.push_back({estimate.stamp, estimate.world_from_body});
  }
  std::vector<PosePair> pairs = associate(poses, truth.poses, tolerance_s);
  for (PosePair& pair : pairs) pair.is_metric = estimates[pair.index].is_metric;
  return pairs;
}

std::vector<EvaluatedMotion> evaluated_motions(std::span<const StampedPose> poses) {
  std::vector<EvaluatedMotion> result;
  result.reserve(poses.size());
  for (const StampedPose& pose : poses) {
    result.push_back({.stamp = pose.stamp, .world_from_body = pose.world_from_body});
  }
  return result;
}

Evaluation evaluate(std::span<const EvaluatedMotion> estimates, const Truth& truth,
                    const EvaluationOptions& options) {
  // 1. Associate by stamp.
  const std::vector<PosePair> raw = matched_poses(estimates, truth, options.tolerance_s);
  Evaluation result{.matched = static_cast<int>(raw.size()), .path_length_m = path_length_m(raw)};

  // 2. Pose errors after alignment.
  result.alignment = best_alignment(raw, options.alignment);
  const std::vector<PosePair> pairs = aligned(raw, result.alignment.value_or(Similarity{}));
  if (result.alignment) {
    result.trajectory = trajectory_error(pairs);
    result.drift_percent = drift_percent(result.trajectory->position, result.path_length_m);
    result.per_frame = relative_error_over_frames(pairs, 1);
    if (result.path_length_m > 0) {
      result.per_tenth = relative_error_over_distance(pairs, result.path_length_m / 10);
    }
  }

  // 3. Velocity and angular-rate errors; only the scale of the alignment applies.
  const double scale = result.alignment.value_or(Similarity{}).scale;
  const std::vector<TwistPair> twists = twist_pairs(estimates, pairs, truth, options, scale);
  result.velocity = twist_error(twists, &Twist::velocity_m_s);
  result.angular_rate = twist_error(twists, &Twist::angular_rate_rad_s);

  // 4. Covariance consistency; pose covariances refer to unaligned errors.
  if (options.alignment == Alignment::none) {
    const PoseNees samples = pose_nees(estimates, pairs);
    result.nees.position = consistency(samples.position, 3);
    result.nees.attitude = consistency(samples.attitude, 3);
  }
  result.nees.velocity = twist_consistency(estimates, twists, &Twist::velocity_m_s, 0);
  result.nees.angular_rate = twist_consistency(estimates, twists, &Twist::angular_rate_rad_s, 3);
  return result;
}

}  // namespace stillkite
