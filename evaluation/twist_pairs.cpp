#include "evaluation/twist_pairs.hpp"

namespace stillkite {
namespace {

struct TrueTwist {
  Twist twist;
  bool has_velocity = false;
  bool has_angular_rate = false;
  bool by_estimated_attitude = false;
};

/// Two consecutive frames. A pair is null without true pose.
struct Interval {
  const EvaluatedMotion& before;
  const EvaluatedMotion& after;
  const PosePair* pair_before;
  const PosePair* pair_after;
  const EvaluationOptions& options;

  [[nodiscard]] bool has_pairs() const { return pair_before && pair_after; }
  [[nodiscard]] double dt_s() const { return seconds_between(before.stamp, after.stamp); }
  [[nodiscard]] Twist twist(RigidTransform PosePair::*pose) const {
    return mean_twist(pair_before->*pose * options.body_from_camera,
                      pair_after->*pose * options.body_from_camera, dt_s());
  }
};

/// True velocity at the middle of the interval, in the camera. std::nullopt without a velocity or
/// an attitude there.
std::optional<Eigen::Vector3d> velocity_in_camera(const Truth& truth, const Interval& interval,
                                                  const Similarity& similarity,
                                                  VelocityAssociation& velocities) {
  constexpr double kHalf = 0.501;  // with the rounding of stamps
  const Timestamp middle{(interval.before.stamp.ns + interval.after.stamp.ns) / 2};
  const auto velocity = velocities.next(middle, kHalf * interval.dt_s());
  const bool is_true = truth.has_attitude && interval.has_pairs();
  if (!velocity || (!is_true && !interval.after.has_attitude)) return std::nullopt;
  const RigidTransform world_from_body =
      is_true ? interpolate(interval.pair_before->truth, interval.pair_after->truth, 0.5)
              : apply(similarity, interpolate(interval.before.world_from_body,
                                              interval.after.world_from_body, 0.5));
  const Eigen::Quaterniond world_from_camera =
      world_from_body.rotation * interval.options.body_from_camera.rotation;
  return world_from_camera.conjugate() * *velocity;
}

std::optional<TrueTwist> true_twist(const Truth& truth, const Interval& interval,
                                    const Similarity& similarity, VelocityAssociation& velocities) {
  if (!truth.twists_in_camera.empty()) {
    const auto twist =
        twist_at(truth.twists_in_camera, interval.after.stamp, interval.options.tolerance_s);
    if (!twist) return std::nullopt;
    return TrueTwist{.twist = *twist, .has_velocity = true, .has_angular_rate = true};
  }
  TrueTwist result;
  if (interval.has_pairs()) {
    result.twist = interval.twist(&PosePair::truth);
    result.has_velocity = truth.has_attitude || interval.after.has_attitude;
    result.has_angular_rate = interval.pair_after->has_attitude;
  }
  result.by_estimated_attitude = !truth.has_attitude || !interval.has_pairs();
  if (!truth.velocities.empty()) {
    const auto velocity = velocity_in_camera(truth, interval, similarity, velocities);
    result.has_velocity = velocity.has_value();
    if (velocity) result.twist.velocity_m_s = *velocity;
  }
  return result;
}

// Poses are differenced across frames without true pose only for true velocities.
bool has_estimated_twist(const Interval& interval, const Truth& truth) {
  return interval.after.twist_in_camera || interval.has_pairs() || !truth.velocities.empty();
}

Twist estimated_twist(const Interval& interval, const Similarity& similarity) {
  if (interval.after.twist_in_camera) {
    return {.velocity_m_s = interval.after.twist_in_camera->velocity_m_s * similarity.scale,
            .angular_rate_rad_s = interval.after.twist_in_camera->angular_rate_rad_s};
  }
  if (interval.has_pairs()) return interval.twist(&PosePair::estimate);
  const auto world_from_camera = [&](const EvaluatedMotion& motion) {
    return apply(similarity, motion.world_from_body) * interval.options.body_from_camera;
  };
  return mean_twist(world_from_camera(interval.before), world_from_camera(interval.after),
                    interval.dt_s());
}

}  // namespace

std::vector<TwistPair> twist_pairs(std::span<const EvaluatedMotion> estimates,
                                   std::span<const PosePair> pairs, const Truth& truth,
                                   const EvaluationOptions& options, const Similarity& similarity) {
  std::vector<const PosePair*> pair_of(estimates.size(), nullptr);
  for (const PosePair& pair : pairs) pair_of[pair.index] = &pair;

  VelocityAssociation velocities(truth.velocities, options.tolerance_s);
  std::vector<TwistPair> result;
  result.reserve(estimates.size());
  for (std::size_t i = 1; i < estimates.size(); ++i) {
    const Interval interval{estimates[i - 1], estimates[i], pair_of[i - 1], pair_of[i], options};
    if (!has_estimated_twist(interval, truth)) continue;
    const auto found = true_twist(truth, interval, similarity, velocities);
    const bool is_metric =
        estimates[i].is_metric && (estimates[i].twist_in_camera || estimates[i - 1].is_metric);
    if (!found) continue;
    const bool has_velocity = found->has_velocity && is_metric;
    if (!has_velocity && !found->has_angular_rate) continue;
    result.push_back({.index = i,
                      .estimate = estimated_twist(interval, similarity),
                      .truth = found->twist,
                      .has_velocity = has_velocity,
                      .has_angular_rate = found->has_angular_rate,
                      .by_estimated_attitude = found->by_estimated_attitude});
  }
  return result;
}

}  // namespace stillkite
