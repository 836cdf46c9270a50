#pragma once

#include <optional>

#include "simulation/flight/simulation_config.hpp"
#include "simulation/flight/trajectory.hpp"
#include "simulation/render/renderer.hpp"

namespace stillkite {

/// Shadow of the aircraft, a ball of `size_m` at the body origin, at `t_s`; nullopt without one.
/// Seen from the shadow at distance r, the sun's disc has the diameter w = 0.0093 r at the
/// aircraft. The shadow is full up to the radius |size - w| / 2, where the aircraft covers
/// min(1, size^2 / w^2) of the disc, and ends at (size + w) / 2; lengths along the sun's azimuth
/// are divided by the sine of its elevation.
[[nodiscard]] std::optional<ShadowPlacement> place_shadow(const SimulationConfig& config,
                                                          const Trajectory& trajectory, double t_s);

}  // namespace stillkite
