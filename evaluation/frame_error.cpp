#include "evaluation/frame_error.hpp"

#include <algorithm>

#include "evaluation/twist_pairs.hpp"

namespace stillkite {
namespace {

std::optional<double>& figure_of(FrameError& error, FrameFigure figure) {
  return error.at(static_cast<std::size_t>(figure));
}

const std::optional<double>& figure_of(const FrameError& error, FrameFigure figure) {
  return error.at(static_cast<std::size_t>(figure));
}

}  // namespace

std::vector<FrameError> frame_errors(std::span<const EvaluatedMotion> estimates, const Truth& truth,
                                     const EvaluationOptions& options) {
  std::vector<FrameError> errors(estimates.size());
  const std::vector<PosePair> poses = matched_poses(estimates, truth, options.tolerance_s);
  for (const PosePair& pair : poses) {
    FrameError& error = errors[pair.index];
    if (pair.has_attitude) {
      figure_of(error, FrameFigure::attitude) =
          so3_log(pair.estimate.rotation * pair.truth.rotation.conjugate()).norm();
    }
    if (!pair.is_metric) continue;
    figure_of(error, FrameFigure::position) =
        (pair.estimate.translation - pair.truth.translation).norm();
  }
  for (const TwistPair& pair : twist_pairs(estimates, poses, truth, options, {})) {
    FrameError& error = errors[pair.index];
    if (pair.has_angular_rate) {
      figure_of(error, FrameFigure::angular_rate) =
          (pair.estimate.angular_rate_rad_s - pair.truth.angular_rate_rad_s).norm();
    }
    if (pair.has_velocity) {
      figure_of(error, FrameFigure::velocity) =
          (pair.estimate.velocity_m_s - pair.truth.velocity_m_s).norm();
    }
  }
  return errors;
}

std::optional<double> mean_error(std::span<const FrameError> errors, FrameFigure figure) {
  double sum = 0;
  int count = 0;
  for (const FrameError& error : errors) {
    if (!figure_of(error, figure)) continue;
    sum += *figure_of(error, figure);
    ++count;
  }
  if (count < 2) return std::nullopt;
  return sum / count;
}

std::optional<MeanInterval> paired_difference(std::span<const FrameError> errors,
                                              std::span<const FrameError> others,
                                              FrameFigure figure) {
  std::vector<double> differences;
  const std::size_t frames = std::min(errors.size(), others.size());
  differences.reserve(frames);
  for (std::size_t i = 0; i < frames; ++i) {
    const std::optional<double>& error = figure_of(errors[i], figure);
    const std::optional<double>& other = figure_of(others[i], figure);
    if (error && other) differences.push_back(*error - *other);
  }
  return correlated_mean_interval(differences);
}

}  // namespace stillkite
