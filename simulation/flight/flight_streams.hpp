#pragma once

#include <cstdint>

#include "simulation/random.hpp"

namespace stillkite {

/// Independent random streams of a free flight.
enum class FlightStream : std::uint64_t {
  ground = 1,
  relief,
  vehicle,
  flight,
  imu,
  range,
  noise,
  flicker,
  clock,
  lens,
  scene,
};

[[nodiscard]] inline std::uint64_t flight_seed(int seed, FlightStream stream) {
  return Random(static_cast<std::uint64_t>(seed), static_cast<std::uint64_t>(stream)).bits();
}

}  // namespace stillkite
