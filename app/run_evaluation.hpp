#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <vector>

#include "evaluation/frame_error.hpp"
#include "io/dataset/flight_inputs.hpp"

namespace stillkite {

/// So many frames with a truth, a path with one bend; with less nothing is judged.
inline constexpr int kFewestToJudge = 3;

/// At which the truth has a pose.
[[nodiscard]] std::int64_t frames_with_truth(const FlightInputs& inputs,
                                             std::span<const NavigationEstimate> estimates);

/// `evaluation` of summary.json: against the truth without any alignment; null where there is
/// none, or too little.
[[nodiscard]] nlohmann::json run_evaluation(const FlightInputs& inputs,
                                            std::span<const NavigationEstimate> estimates);

/// One for each estimate; empty where there is no truth, or too little.
[[nodiscard]] std::vector<FrameError> run_frame_errors(
    const FlightInputs& inputs, std::span<const NavigationEstimate> estimates);

/// The truth at each estimate; empty where there is none at all.
[[nodiscard]] std::vector<std::optional<RigidTransform>> truth_at(
    const FlightInputs& inputs, std::span<const NavigationEstimate> estimates);

}  // namespace stillkite
