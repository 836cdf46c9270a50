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

/// What one frame's answer can be wrong in; the names end in the unit of the error's magnitude.
enum class FrameFigure { position, velocity, attitude, angular_rate };

template <>
struct EnumNames<FrameFigure> {
  static constexpr auto value = std::to_array<std::pair<FrameFigure, std::string_view>>(
      {{FrameFigure::position, "position_m"},
       {FrameFigure::velocity, "velocity_m_s"},
       {FrameFigure::attitude, "attitude_rad"},
       {FrameFigure::angular_rate, "angular_rate_rad_s"}});
};

/// Magnitudes of one frame's errors, by FrameFigure; nothing where estimate or truth does not know.
using FrameError = std::array<std::optional<double>, EnumNames<FrameFigure>::value.size()>;

/// One for each estimate, without alignment and by the rules of `evaluate`: velocities half way
/// between the frame before and this one, in the camera; of an estimate that is not metric only
/// attitude and angular rate.
[[nodiscard]] std::vector<FrameError> frame_errors(std::span<const JudgedMotion> estimates,
                                                   const Truth& truth,
                                                   const EvaluationOptions& options = {});

/// Mean of a figure over the frames that have it; nothing without any.
[[nodiscard]] std::optional<double> mean_error(std::span<const FrameError> errors,
                                               FrameFigure figure);

/// By how much the first estimator's error is greater than the second's on average, frame by frame
/// over those that both know; a test of equal accuracy in the sense of Diebold and Mariano (Journal
/// of Business & Economic Statistics 13(3), 1995) with the interval of batch means. Both spans
/// begin with the same frame. Nothing of less than twenty frames.
[[nodiscard]] std::optional<MeanInterval> paired_difference(std::span<const FrameError> errors,
                                                            std::span<const FrameError> others,
                                                            FrameFigure figure);

}  // namespace stillkite
