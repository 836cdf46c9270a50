#pragma once

#include <optional>

#include "simulation/flight/simulation_config.hpp"
#include "simulation/flight/trajectory.hpp"
#include "simulation/render/renderer.hpp"

namespace stillkite {

/// Position of the vehicle at `t_s`; nullopt without a vehicle. Each crossing has constant
/// velocity, from beyond the left border of the image to beyond the right one. At half time the
/// vehicle is below the camera.
[[nodiscard]] std::optional<VehiclePlacement> place_vehicle(const SimulationConfig& config,
                                                            const Trajectory& trajectory,
                                                            double t_s);

}  // namespace stillkite
