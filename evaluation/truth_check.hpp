#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "evaluation/evaluation.hpp"

namespace stillkite {

/// Error of the truth file, not of the estimate, that explains most of the difference.
struct TruthMismatch {
  enum class Cause : std::uint8_t {
    clock,    ///< the truth's stamps are `value` s ahead
    heading,  ///< the truth's positions are rotated by `value` rad about the vertical
    scale,    ///< the truth's lengths are `value` times those of the estimate
  };
  Cause cause;
  double value = 0;
  double explained_ratio = 0;  ///< of the RMS difference
};

/// Compares speeds at time offsets of up to 10 s, else positions after a rotation and, horizontal
/// ones, a scaling.
/// Reported are offsets above 30 ms that halve the RMS difference of the speeds, rotations above 5
/// degrees and factors above 3 that leave less than 20 and 40 % of that of the positions.
[[nodiscard]] std::optional<TruthMismatch> truth_mismatch(
    std::span<const EvaluatedMotion> estimates, const Truth& truth,
    const EvaluationOptions& options = {});

/// Step of the truth that no motion explains: an outlier, or tracking that was lost and held.
struct TruthJump {
  Timestamp stamp;  ///< of the row after the largest one
  double length_m = 0;
  int count = 0;
};

/// Steps above 0.3 m and ten times the 90 % quantile of the speeds between rows.
[[nodiscard]] std::optional<TruthJump> truth_jump(std::span<const StampedPose> truth);

}  // namespace stillkite
