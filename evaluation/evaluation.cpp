#include "evaluation/evaluation.hpp"

#include <algorithm>
#include <cmath>

#include "evaluation/twist_pairs.hpp"
#include "geometry/angle.hpp"

namespace stillkite {
namespace {

bool is_comparable(const TwistPair& pair, Eigen::Vector3d Twist::*part) {
  return part == &Twist::velocity_m_s ? pair.has_velocity : pair.has_angular_rate;
}

Eigen::Matrix3d with_truth_sigma(const Eigen::Matrix3d& covariance, double sigma) {
  return covariance + sigma * sigma * Eigen::Matrix3d::Identity();
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

/// Covariance of a true velocity v that the estimated attitude rotates to the camera:
/// [v]x P_attitude [v]x^T.
Eigen::Matrix3d rotated_velocity_covariance(const EvaluatedMotion& motion, const Eigen::Vector3d& v,
                                            const RigidTransform& body_from_camera) {
  if (!motion.pose_covariance) return Eigen::Matrix3d::Zero();
  const Eigen::Matrix3d R =
      (motion.world_from_body.rotation * body_from_camera.rotation).toRotationMatrix();
  const Eigen::Matrix3d P_attitude = motion.pose_covariance->angular;
  const Eigen::Matrix3d J = skew(v) * R.transpose();
  return J * P_attitude * J.transpose();
}

std::optional<Consistency> velocity_consistency(std::span<const EvaluatedMotion> estimates,
                                                std::span<const TwistPair> pairs, double sigma_m_s,
                                                const RigidTransform& body_from_camera) {
  NormalizedErrors errors;
  for (const TwistPair& pair : pairs) {
    const EvaluatedMotion& motion = estimates[pair.index];
    if (!motion.twist_covariance || !pair.has_velocity) continue;
    Eigen::Matrix3d P = motion.twist_covariance->linear;
    if (pair.by_estimated_attitude) {
      P += rotated_velocity_covariance(motion, pair.truth.velocity_m_s, body_from_camera);
    }
    errors.add(pair.estimate.velocity_m_s - pair.truth.velocity_m_s,
               with_truth_sigma(P, sigma_m_s));
  }
  return errors.consistency();
}

std::optional<Consistency> rate_consistency(std::span<const EvaluatedMotion> estimates,
                                            std::span<const TwistPair> pairs, double sigma_rad_s) {
  NormalizedErrors errors;
  for (const TwistPair& pair : pairs) {
    const auto& P = estimates[pair.index].twist_covariance;
    if (!P || !pair.has_angular_rate) continue;
    errors.add(pair.estimate.angular_rate_rad_s - pair.truth.angular_rate_rad_s,
               with_truth_sigma(P->angular, sigma_rad_s));
  }
  return errors.consistency();
}

struct PoseErrors {
  NormalizedErrors position, attitude;
};

PoseErrors pose_errors(std::span<const EvaluatedMotion> estimates, std::span<const PosePair> pairs,
                       const TruthSigma& sigma) {
  PoseErrors errors;
  for (const PosePair& pair : pairs) {
    const auto& P = estimates[pair.index].pose_covariance;
    if (!P) continue;
    if (pair.is_metric) {
      errors.position.add(pair.estimate.translation - pair.truth.translation,
                          with_truth_sigma(P->linear, sigma.position_m));
    }
    if (pair.has_attitude) {
      errors.attitude.add(so3_log(pair.estimate.rotation * pair.truth.rotation.conjugate()),
                          with_truth_sigma(P->angular, sigma.attitude_rad));
    }
  }
  return errors;
}

void share_attitude(std::vector<PosePair>& pairs, bool truth_has_attitude) {
  for (PosePair& pair : pairs) {
    if (pair.has_attitude) continue;
    RigidTransform& unknown = truth_has_attitude ? pair.estimate : pair.truth;
    unknown.rotation = truth_has_attitude ? pair.truth.rotation : pair.estimate.rotation;
  }
}

std::optional<double> percent_of(const std::optional<double>& error_m, double path_length_m) {
  if (!error_m || !(path_length_m > 0)) return std::nullopt;
  return 100 * *error_m / path_length_m;
}

std::optional<double> end_error_m(const PositionError& error) {
  if (!error.end) return std::nullopt;
  return std::hypot(error.end->horizontal_m, error.end->vertical_m);
}

bool is_metric_source(ScaleSource scale) {
  return scale != ScaleSource::none;
}

}  // namespace

EvaluatedMotion evaluated_motion(const NavigationEstimate& estimate) {
  EvaluatedMotion motion{.stamp = estimate.stamp,
                         .world_from_body = estimate.world_from_body,
                         .is_metric = is_metric_source(estimate.scale),
                         .pose_covariance = estimate.pose_covariance};
  if (estimate.verdict != Verdict::first_frame) {
    motion.twist_in_camera = estimate.twist_in_camera;
    motion.twist_covariance = estimate.twist_covariance;
  }
  return motion;
}

std::vector<EvaluatedMotion> evaluated_motions(std::span<const NavigationEstimate> estimates) {
  std::vector<EvaluatedMotion> result;
  result.reserve(estimates.size());
  for (const NavigationEstimate& estimate : estimates) result.push_back(evaluated_motion(estimate));
  return result;
}

bool contradicts_constant_attitude(std::span<const EvaluatedMotion> estimates,
                                   std::span<const StampedPose> truth) {
  constexpr double kMinRotation_rad = 20 * kDegree;
  if (truth.size() < 2 || estimates.empty()) return false;
  const bool is_constant = std::ranges::all_of(truth, [&](const StampedPose& pose) {
    return pose.world_from_body.rotation.coeffs() ==
           truth.front().world_from_body.rotation.coeffs();
  });
  const Eigen::Quaterniond& first = estimates.front().world_from_body.rotation;
  return is_constant && std::ranges::any_of(estimates, [&](const EvaluatedMotion& motion) {
           return motion.has_attitude &&
                  angle_between_rad(motion.world_from_body.rotation, first) > kMinRotation_rad;
         });
}

std::vector<PosePair> matched_poses(std::span<const EvaluatedMotion> estimates, const Truth& truth,
                                    double tolerance_s) {
  std::vector<StampedPose> poses;
  poses.reserve(estimates.size());
  for (const EvaluatedMotion& estimate : estimates) {
    poses.push_back({estimate.stamp, estimate.world_from_body});
  }
  std::vector<PosePair> pairs = associate(poses, truth.poses, tolerance_s);
  for (PosePair& pair : pairs) {
    pair.is_metric = estimates[pair.index].is_metric;
    pair.has_attitude = truth.has_attitude && estimates[pair.index].has_attitude;
  }
  share_attitude(pairs, truth.has_attitude);
  return pairs;
}

std::vector<EvaluatedMotion> evaluated_motions(std::span<const StampedPose> poses,
                                               bool has_attitude) {
  std::vector<EvaluatedMotion> result;
  result.reserve(poses.size());
  for (const StampedPose& pose : poses) {
    result.push_back({.stamp = pose.stamp,
                      .world_from_body = pose.world_from_body,
                      .has_attitude = has_attitude});
  }
  return result;
}

Evaluation evaluate(std::span<const EvaluatedMotion> estimates, const Truth& truth,
                    const EvaluationOptions& options) {
  // 1. Associate by stamp.
  std::vector<PosePair> pairs = matched_poses(estimates, truth, options.tolerance_s);
  Evaluation result;

  // 2. Pose errors after alignment.
  result.alignment = best_alignment(pairs, options.alignment);
  const Similarity similarity = result.alignment.value_or(Similarity{});
  if (options.alignment != Alignment::none) {
    pairs = aligned(pairs, similarity);
    share_attitude(pairs, truth.has_attitude);
  }
  const double length_m = path_length_m(pairs);
  if (!pairs.empty()) result.path_length_m = length_m;
  if (result.alignment) {
    result.trajectory = trajectory_error(pairs);
    if (result.trajectory && result.trajectory->position) {
      result.drift_percent = percent_of(end_error_m(*result.trajectory->position), length_m);
      result.rmse_percent = percent_of(result.trajectory->position->rmse_m, length_m);
    }
    result.per_frame = relative_error_over_frames(pairs, 1);
    result.per_metre = relative_error_over_distance(pairs, 1);
    if (length_m > 0) result.per_tenth = relative_error_over_distance(pairs, length_m / 10);
  }

  // 3. Velocity and angular-rate errors.
  const std::vector<TwistPair> twists = twist_pairs(estimates, pairs, truth, options, similarity);
  result.velocity = twist_error(twists, &Twist::velocity_m_s);
  result.angular_rate = twist_error(twists, &Twist::angular_rate_rad_s);
  result.matched = static_cast<int>(pairs.empty() ? twists.size() : pairs.size());

  // 4. Covariance consistency; pose covariances refer to unaligned errors.
  if (options.alignment == Alignment::none) {
    const PoseErrors errors = pose_errors(estimates, pairs, truth.sigma);
    result.nees.position = errors.position.consistency();
    result.nees.attitude = errors.attitude.consistency();
  }
  result.nees.velocity =
      velocity_consistency(estimates, twists, truth.sigma.velocity_m_s, options.body_from_camera);
  result.nees.angular_rate = rate_consistency(estimates, twists, truth.sigma.angular_rate_rad_s);
  return result;
}

}  // namespace stillkite
