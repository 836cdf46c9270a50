#include "evaluation/twist_pairs.hpp"

namespace stillkite {
namespace {

Twist twist_between(const PosePair& before, const PosePair& after, RigidTransform PosePair::*pose,
                    const RigidTransform& body_from_camera) {
  return mean_twist(before.*pose * body_from_camera, after.*pose * body_from_camera,
                    seconds_between(before.stamp, after.stamp));
}

}  // namespace

std::vector<TwistPair> twist_pairs(std::span<const EvaluatedMotion> estimates,
                                   std::span<const PosePair> pairs, const Truth& truth,
                                   const EvaluationOptions& options, double scale) {
  std::vector<const PosePair*> pair_of(estimates.size(), nullptr);
  for (const PosePair& pair : pairs) pair_of[pair.index] = &pair;

  std::vector<TwistPair> result;
  result.reserve(estimates.size());
  for (std::size_t i = 1; i < estimates.size(); ++i) {
    const PosePair* before = pair_of[i - 1];
    const PosePair* after = pair_of[i];
    const auto from_poses = [&](RigidTransform PosePair::*pose) -> std::optional<Twist> {
      if (!before || !after) return std::nullopt;
      return twist_between(*before, *after, pose, options.body_from_camera);
    };
    std::optional<Twist> estimate = estimates[i].twist_in_camera;
    if (estimate) {
      estimate->velocity_m_s *= scale;
    } else {
      estimate = from_poses(&PosePair::estimate);
    }
    const std::optional<Twist> true_twist =
        truth.twists_in_camera.empty()
            ? from_poses(&PosePair::truth)
            : twist_at(truth.twists_in_camera, estimates[i].stamp, options.tolerance_s);
    const bool is_metric =
        estimates[i].is_metric && (estimates[i].twist_in_camera || estimates[i - 1].is_metric);
    if (estimate && true_twist) {
      result.push_back(
          {.index = i, .estimate = *estimate, .truth = *true_twist, .is_metric = is_metric});
    }
  }
  return result;
}

}  // namespace stillkite
