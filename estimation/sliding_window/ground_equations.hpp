#pragma once

#include <cstddef>
#include <vector>

#include "estimation/sliding_window/reprojection_errors.hpp"
#include "estimation/sliding_window/window_equations.hpp"

// Alignments over the ground in the normal equations. Those to one keyframe have common errors,
// which are eliminated: the noise of the keyframe's image, half the covariance of an alignment, and
// the relief of the ground below the keyframe, an error of its height.

namespace stillkite {

/// Relative poses at the present estimate and at the linearization points.
struct WindowGeometry {
  CameraPairs& present;
  CameraPairs& first;
  GroundViews& present_ground;
  GroundViews& first_ground;
};

/// Adds alignments (indices in Window::alignments, ascending).
void add_ground_alignments(const Window& window, const std::vector<std::size_t>& alignments,
                           const WindowGeometry& geometry, WindowLinearization& out);

/// Half their squared residuals, over their covariance; without the likeliest tilt's constant.
[[nodiscard]] double ground_alignments_cost(const Window& window,
                                            const std::vector<std::size_t>& alignments,
                                            CameraPairs& pairs, GroundViews& ground);

/// Squared motion residual of one alignment over its covariance; expected value 6.
[[nodiscard]] double squared_error(const Window& window, const GroundAlignment& alignment);

}  // namespace stillkite
