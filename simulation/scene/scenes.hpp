#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "simulation/scene/patch_scene.hpp"

namespace stillkite {

/// Laboratory of 12 x 10 x 4 m, deterministic in the seed; the world origin is the centre of its
/// floor. Furniture and posters along the walls are at distances of 3 to 6 m.
[[nodiscard]] PatchScene make_room(std::uint64_t seed);

/// Length, width and height.
[[nodiscard]] Eigen::Vector3d room_size_m();

/// Static coast scene for a boat at the origin, bow towards +x, water surface z = 0. Ahead and to
/// the right: a shore with houses, and rocks and another boat in front of it. To the left: the sea
/// up to the horizon. Above: clouds.
[[nodiscard]] PatchScene make_coast(std::uint64_t seed);

}  // namespace stillkite
