#pragma once

#include <cstdint>

#include "simulation/scene/patch_scene.hpp"

namespace stillkite {

/// Static coast scene for a boat at the origin, bow towards +x, water surface z = 0. Ahead and to
/// the right: a shore with houses, and rocks and another boat in front of it. To the left: the sea
/// up to the horizon. Above: clouds.
[[nodiscard]] PatchScene make_coast(std::uint64_t seed);

}  // namespace stillkite
