#pragma once

#include <optional>

#include "estimation/sliding_window/window.hpp"

namespace stillkite {

/// Point of a track from the window's poses: inverse depth by least squares along the bearing of
/// the first keyframe. Empty unless the depth is positive and known to 20 %, and the point
/// explains the observations (mean squared error below nine times the expected one).
[[nodiscard]] std::optional<InverseDepthPoint> triangulate(const Window& window,
                                                           const WindowTrack& track);

}  // namespace stillkite
