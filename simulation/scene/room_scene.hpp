#pragma once

#include <cstdint>

#include "simulation/scene/patch_scene.hpp"

namespace stillkite {

/// A laboratory of 12 x 10 m and 4 m height around the world's origin, which lies on its floor:
/// along its walls shelves, cabinets, tables, cartons and posters at 3 to 6 m, with free floor
/// between. The same for the same seed.
[[nodiscard]] PatchScene make_room(std::uint64_t seed);

}  // namespace stillkite
