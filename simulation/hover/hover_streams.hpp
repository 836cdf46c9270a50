#pragma once

#include <cstdint>

#include "simulation/random.hpp"

namespace stillkite {

/// Independent random streams of closed-loop trials.
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
