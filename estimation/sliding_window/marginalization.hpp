#pragma once

#include <cstddef>

#include "estimation/sliding_window/window.hpp"

namespace stillkite {

/// Marginalizes velocity and biases of a frame, with the IMU factor that follows it; its pose
/// stays.
void marginalize_motion(Window& window, std::size_t frame);

/// Marginalizes a frame, with the IMU factors at it and the points of which it is the first
/// keyframe. Their observations in the newest frame are kept. Observations of other points in it
/// are removed.
void marginalize_frame(Window& window, std::size_t frame);

/// Removes a frame that the prior does not depend on; the IMU factors at it become one, and its
/// observations are removed.
void merge_frame(Window& window, std::size_t frame);

/// Removes the first frame, which the prior does not depend on, with its observations.
void remove_first_frame(Window& window);

}  // namespace stillkite
