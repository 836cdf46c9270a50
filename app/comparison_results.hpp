#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "app/variants.hpp"
#include "evaluation/frame_error.hpp"

namespace stillkite {

/// What one estimator made of the frames.
struct ComparedRun {
  std::string name;
  std::vector<std::string> overrides;
  EstimatorConfig estimator;
  nlohmann::json summary;          ///< its summary.json
  std::vector<FrameError> errors;  ///< by frame; empty without truth
  double own_s = 0;                ///< its steps alone
};

/// What comparison.json says beside the estimators themselves.
struct ComparisonFacts {
  std::int64_t frames_read = 0;
  double wall_s = 0;      ///< of the whole loop
  double decoding_s = 0;  ///< on threads of its own, mostly beside the estimators
  int threads = 1;        ///< of an estimator
  bool interrupted = false;
  std::optional<std::string> complaint;  ///< about the source
};

/// comparison.json: what is unknown is null. An estimator's `availability_ratio` is the share of
/// the frames read whose answer can be used (verdict ok or first_frame). `differences` lists every
/// pair, with the 95 % interval of the mean difference of a frame's error and its verdict: `of` is
/// better or worse than `against`, not_significant, or drifting where one flight cannot tell.
[[nodiscard]] nlohmann::json comparison_json(std::span<const ComparedRun> runs,
                                             const ComparisonFacts& facts);

/// The word for such a difference of errors.
[[nodiscard]] std::string_view difference_verdict(const MeanInterval& difference);

}  // namespace stillkite
