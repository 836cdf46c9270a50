#pragma once

#include <span>
#include <vector>

#include "evaluation/evaluation.hpp"

namespace stillkite {

/// The camera's motion at one estimate, as estimated and true.
struct TwistPair {
  std::size_t index = 0;  ///< of the estimate
  Twist estimate;
  Twist truth;
  bool is_metric = true;  ///< false: the estimate's velocity is not in m/s
};

/// Where estimate and truth both know the motion. Where the truth has velocities of its own, an
/// estimate needs no true pose to be judged. `pairs` are the estimates that have one, laid onto the
/// truth with that `scale`.
[[nodiscard]] std::vector<TwistPair> twist_pairs(std::span<const JudgedMotion> estimates,
                                                 std::span<const PosePair> pairs,
                                                 const Truth& truth,
                                                 const EvaluationOptions& options, double scale);

}  // namespace stillkite
