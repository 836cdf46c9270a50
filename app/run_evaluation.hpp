#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "evaluation/evaluation.hpp"
#include "evaluation/frame_error.hpp"
#include "io/dataset/flight_inputs.hpp"

namespace stillkite {

/// Minimum number of frames with truth for an evaluation.
inline constexpr int kMinEvaluatedFrames = 3;

/// Truth with its own error.
[[nodiscard]] Truth truth_of(const GroundTruth& truth, const TruthConfig& config);

/// Number of frames with a true pose, or of those with a true velocity if there is no pose.
[[nodiscard]] std::int64_t frames_with_truth(const FlightInputs& inputs,
                                             std::span<const EvaluatedMotion> motions);

/// Messages of truth_jump and truth_mismatch with their remedies; `offset_option` adds to the
/// truth's stamps and is `offset_s` now.
[[nodiscard]] std::vector<std::string> truth_messages(std::span<const EvaluatedMotion> motions,
                                                      const Truth& truth,
                                                      const EvaluationOptions& options,
                                                      std::string_view offset_option,
                                                      double offset_s);

/// `evaluation` of summary.json; unavailable figures are null.
[[nodiscard]] nlohmann::json evaluation_json(const Evaluation& evaluation);

/// The same for a run: errors against the truth without alignment; null with fewer than
/// kMinEvaluatedFrames frames with truth.
[[nodiscard]] nlohmann::json run_evaluation(const FlightInputs& inputs, const TruthConfig& config,
                                            std::span<const EvaluatedMotion> motions,
                                            const std::optional<ReferenceError>& reference);

/// Errors of each frame; empty with fewer than kMinEvaluatedFrames frames with truth.
[[nodiscard]] std::vector<FrameError> run_frame_errors(const FlightInputs& inputs,
                                                       std::span<const EvaluatedMotion> motions);

}  // namespace stillkite
