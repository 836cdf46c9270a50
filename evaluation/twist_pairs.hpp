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
  bool is_metric = true;  ///< false: estimated velocity without metric scale
};

/// Twists of frames with both an estimate and a truth. With `truth.twists_in_camera` a frame needs
/// no true pose. `pairs`: estimates with a true pose, aligned with `scale`.
[[nodiscard]] std::vector<TwistPair> twist_pairs(std::span<const EvaluatedMotion> estimates,
                                                 std::span<const PosePair> pairs,
                                                 const Truth& truth,
                                                 const EvaluationOptions& options, double scale);

}  // namespace stillkite
