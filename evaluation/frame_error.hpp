#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "evaluation/evaluation.hpp"
#include "evaluation/mean_interval.hpp"

namespace stillkite {

/// Quantity of a frame error; the names end in the unit.
enum class FrameFigure { position, velocity, attitude, angular_rate };

template <>
struct EnumNames<FrameFigure> {
  static constexpr auto value = std::to_array<std::pair<FrameFigure, std::string_view>>(
      {{FrameFigure::position, "position_m"},
       {FrameFigure::velocity, "velocity_m_s"},
       {FrameFigure::attitude, "attitude_rad"},
       {FrameFigure::angular_rate, "angular_rate_rad_s"}});
};

/// Error magnitudes of one frame by FrameFigure; empty if estimate or truth lacks the quantity.
using FrameError = std::array<std::optional<double>, EnumNames<FrameFigure>::value.size()>;

/// One FrameError per estimate, without alignment, by the rules of `evaluate`: velocities half way
/// between consecutive frames, in the camera; attitude and angular rate only if not metric.
[[nodiscard]] std::vector<FrameError> frame_errors(std::span<const EvaluatedMotion> estimates,
                                                   const Truth& truth,
                                                   const EvaluationOptions& options = {});

/// Mean over the frames that have the quantity; std::nullopt with fewer than two.
[[nodiscard]] std::optional<double> mean_error(std::span<const FrameError> errors,
                                               FrameFigure figure);

/// Mean paired difference errors - others, over the frames that have both: test of equal accuracy
/// (Diebold and Mariano, Journal of Business & Economic Statistics 13(3), 1995) with the
/// batch-means interval. Both spans begin with the same frame. std::nullopt below 20 frames.
[[nodiscard]] std::optional<MeanInterval> paired_difference(std::span<const FrameError> errors,
                                                            std::span<const FrameError> others,
                                                            FrameFigure figure);

}  // namespace stillkite
