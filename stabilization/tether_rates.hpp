#pragma once

#include <Eigen/Core>

#include "stabilization/tether.hpp"
#include "stabilization/vehicle_limits.hpp"

namespace stillkite {

/// Columns: unit vectors of growing length, elevation and azimuth in the station's frame;
/// orthogonal for any state.
[[nodiscard]] Eigen::Matrix3d tether_axes_in_station(const TetherState& tether);

/// Lever arms of length, elevation and azimuth along `tether_axes_in_station`: 1, l and l cos e.
/// The Jacobian of (9)-(11) is axes * levers.asDiagonal(). The last lever is negative beyond the
/// zenith.
[[nodiscard]] Eigen::Vector3d tether_levers_m(const TetherState& tether);

/// Velocity of the drone in the station's frame under a command; its yaw rate has no effect.
[[nodiscard]] Eigen::Vector3d velocity_in_station_m_s(const TetherState& tether,
                                                      const TetherCommand& command);

/// Azimuth control near the zenith, where the azimuth's lever vanishes.
struct ZenithAzimuth {
  double radius_m;    ///< horizontal distance from the zenith within which it applies
  double rate_rad_s;  ///< at the zenith
};

/// Tether rates for a velocity: inverse Jacobian. The elevation is damped for tethers shorter than
/// `damped_within_m` (Nakamura and Hanafusa 1986): l / (l^2 + d^2), with d^2 falling from
/// (damped_within_m / 2)^2 at length 0 to 0 at `damped_within_m`; beyond it is exact. Within
/// `zenith.radius_m` the azimuth rate blends from the inverse to `zenith.rate_rad_s` by the squared
/// lever; that rate may temporarily move the drone against the velocity.
[[nodiscard]] TetherCommand rates_for_velocity(const TetherState& tether,
                                               const Eigen::Vector3d& velocity_in_station_m_s,
                                               double damped_within_m, const ZenithAzimuth& zenith);

/// Limits each rate, and stops length and elevation at their ends: a rate is at most (distance to
/// the end) / `braking_time_s`. Beyond an end, 0 is always allowed.
[[nodiscard]] TetherCommand within_limits(const VehicleLimits& limits, const TetherState& tether,
                                          const TetherCommand& command);

}  // namespace stillkite
