#pragma once

#include <cstddef>
#include <optional>

#include "estimation/sliding_window/window.hpp"

namespace stillkite {

/// Frame with the closest neighbours in time that is no keyframe, first and last excluded. Empty if
/// all others are keyframes.
[[nodiscard]] std::optional<std::size_t> closest_frame(const Window& window);

/// Keyframe with a pose only whose points are out of view, else the one closest to its neighbours
/// (Engel et al., "Direct sparse odometry", IEEE T-PAMI 2018, section 3.1). The reference keyframe
/// stays, with the keyframe that knows the depths of its points best. There are at least three.
[[nodiscard]] std::size_t redundant_keyframe(const Window& window);

}  // namespace stillkite
