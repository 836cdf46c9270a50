#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <vector>

#include "evaluation/frame_error.hpp"
#include "io/dataset/flight_inputs.hpp"

namespace stillkite {

/// Minimum number of frames with truth for an evaluation.
inline constexpr int kMinEvaluatedFrames = 3;

/// Number of estimates with a truth pose.
[[nodiscard]] std::int64_t frames_with_truth(const FlightInputs& inputs,
                                             std::span<const NavigationEstimate> estimates);

/// `evaluation` of summary.json: errors against the truth without alignment; null with fewer than
/// kMinEvaluatedFrames truth poses.
[[nodiscard]] nlohmann::json run_evaluation(const FlightInputs& inputs,
                                            std::span<const NavigationEstimate> estimates);

/// Errors of each estimate; empty with fewer than kMinEvaluatedFrames truth poses.
[[nodiscard]] std::vector<FrameError> run_frame_errors(
    const FlightInputs& inputs, std::span<const NavigationEstimate> estimates);

/// Truth at each estimate; an empty vector without truth.
[[nodiscard]] std::vector<std::optional<RigidTransform>> truth_at(
    const FlightInputs& inputs, std::span<const NavigationEstimate> estimates);

}  // namespace stillkite
