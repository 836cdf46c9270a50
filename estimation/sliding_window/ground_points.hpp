#pragma once

#include "estimation/sliding_window/window.hpp"

// Points on the ground plane of a window whose height above it is known.

namespace stillkite {

/// Puts the tracks without a point on the ground, where their rays meet it. Returns their number.
std::size_t place_on_ground(Window& window);

/// Relief of the ground by the points' depths as images alone show them, then each point's
/// probability to be on it. Removes points that neither images nor ground locate.
void update_ground_points(Window& window);

/// Decides that the ground is level if its slope, as measured, is much more probable for a level
/// one (ratio of Savage and Dickey; Dickey 1971).
void level_ground(Window& window);

/// The points of these tracks leave with what the ground has measured of them.
void keep_ground_points(Window& window, const std::vector<std::size_t>& tracks);

}  // namespace stillkite
