#pragma once

#include "simulation/flight/simulation_config.hpp"
#include "simulation/flight/trajectory.hpp"

namespace stillkite {

/// Throws InputError if keys of the configuration contradict each other, or if the flight leaves
/// the room.
void check_flight(const SimulationConfig& config, const Trajectory& trajectory);

}  // namespace stillkite
