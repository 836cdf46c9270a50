#pragma once

#include <optional>

#include "simulation/flight/simulation_config.hpp"
#include "simulation/flight/trajectory.hpp"
#include "simulation/render/renderer.hpp"

namespace stillkite {

/// Where the configured vehicle is; nothing if there is none. Crossing after crossing it drives
/// straight and steadily over the ground, through the point under the camera at half time, from
/// beyond the left border of the image to beyond the right one as seen from the flight there.
[[nodiscard]] std::optional<VehiclePlacement> place_vehicle(const SimulationConfig& config,
                                                            const Trajectory& trajectory,
                                                            double t_s);

}  // namespace stillkite
