#include "simulation/flight/shadow_path.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/angle.hpp"

namespace stillkite {

std::optional<ShadowPlacement> place_shadow(const SimulationConfig& config,
                                            const Trajectory& trajectory, double t_s) {
  if (!config.shadow) return std::nullopt;
  constexpr double kSunDiameter_rad = 0.0093;
  const AircraftShadowConfig& shadow = *config.shadow;
  const double elevation_rad = shadow.sun_elevation_deg * kDegree;
  const double azimuth_rad = shadow.sun_azimuth_deg * kDegree;
  const Eigen::Vector3d aircraft = trajectory.at(t_s).world_from_body.translation;
  const double penumbra_m = kSunDiameter_rad * aircraft.z() / std::sin(elevation_rad);
  const double coverage = std::min(1.0, std::pow(shadow.size_m / penumbra_m, 2));
  const Eigen::Vector2d towards_sun(std::cos(azimuth_rad), std::sin(azimuth_rad));
  return ShadowPlacement{.centre_in_world_m = aircraft.head<2>() -
                                              aircraft.z() / std::tan(elevation_rad) * towards_sun,
                         .sun_azimuth_rad = azimuth_rad,
                         .sun_elevation_rad = elevation_rad,
                         .inner_radius_m = 0.5 * std::abs(shadow.size_m - penumbra_m),
                         .outer_radius_m = 0.5 * (shadow.size_m + penumbra_m),
                         .darkening_ratio = shadow.darkening_ratio * coverage};
}

}  // namespace stillkite
