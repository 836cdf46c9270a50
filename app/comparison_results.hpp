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

/// Results of one estimator.
struct ComparedRun {
  std::string name;
  std::vector<std::string> overrides;
  EstimatorConfig estimator;
  nlohmann::json summary;          ///< its summary.json
  std::vector<FrameError> errors;  ///< per frame; empty without truth
  double estimator_s = 0;          ///< time in its steps
};

/// Facts of a comparison in addition to the estimators' results.
struct ComparisonFacts {
  std::int64_t frames_read = 0;
  double wall_s = 0;      ///< whole loop
  double decoding_s = 0;  ///< on separate threads, mostly parallel to the estimators
  int threads = 1;        ///< per estimator
  bool interrupted = false;
  std::optional<std::string> problem;  ///< of the source
};

/// comparison.json; unavailable figures are null. `availability_ratio`: share of the frames read
/// with verdict ok or first_frame. `differences`: for every pair of estimators, the 95 % interval
/// of the mean difference of their per-frame errors and its verdict. `of` is better or worse than
/// `against`, not_significant, or drifting (errors correlated over too long for one flight).
[[nodiscard]] nlohmann::json comparison_json(std::span<const ComparedRun> runs,
                                             const ComparisonFacts& facts);

/// Verdict token of a mean error difference.
[[nodiscard]] std::string_view difference_verdict(const MeanInterval& difference);

/// Text table of the main figures of comparison.json, one column per estimator. Errors are marked
/// if they differ significantly from the first estimator's.
[[nodiscard]] std::string comparison_table(const nlohmann::json& comparison);

}  // namespace stillkite
