#pragma once

#include <span>
#include <vector>

#include "evaluation/evaluation.hpp"

namespace stillkite {

/// Estimated and true camera twist of one frame.
struct TwistPair {
  std::size_t index = 0;  ///< index of the estimate
  Twist estimate;
  Twist truth;
  bool has_velocity = false;           ///< false: no true velocity, or no metric scale
  bool has_angular_rate = false;       ///< false: no true angular rate
  bool by_estimated_attitude = false;  ///< true velocity known in the world only
};

/// Twists of frames with an estimate and a true velocity or angular rate. With
/// `truth.twists_in_camera` or `truth.velocities` a frame needs no true pose. Without true attitude
/// the estimated one rotates the true velocity to the camera. `pairs`: estimates with a true pose,
/// aligned with `similarity`.
[[nodiscard]] std::vector<TwistPair> twist_pairs(std::span<const EvaluatedMotion> estimates,
                                                 std::span<const PosePair> pairs,
                                                 const Truth& truth,
                                                 const EvaluationOptions& options,
                                                 const Similarity& similarity);

}  // namespace stillkite
