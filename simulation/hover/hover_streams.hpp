#pragma once

#include <cstdint>

#include "simulation/random.hpp"

namespace stillkite {

/// What draws random numbers in closed-loop trials; each by itself, so that one more draw of one
/// does not change another's.
enum class HoverStream : std::uint64_t {
  scene = 1,
  trials,
  trial_sensors,
  trial_wind,
  trial_kicks,
  pixels,
  trial_sea,
  trial_moving_objects,
};

[[nodiscard]] inline Random hover_random(std::uint64_t seed, HoverStream stream) {
  return Random(seed, static_cast<std::uint64_t>(stream));
}

}  // namespace stillkite
