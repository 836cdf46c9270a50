#pragma once

#include <cstdint>

#include "simulation/scene/patch_scene.hpp"

namespace stillkite {

/// A shore seen from a boat that lies at the origin, on the water z = 0, bow towards +x: a beach
/// with houses ahead and to the right, rocks and another boat before it, to the left the sea up to
/// its horizon, above it clouds. Nothing moves.
[[nodiscard]] PatchScene make_coast(std::uint64_t seed);

}  // namespace stillkite
