#pragma once

#include <Eigen/Core>

#include "stabilization/tether.hpp"
#include "stabilization/vehicle_limits.hpp"

namespace stillkite {

/// Columns: where the tether's length, elevation and azimuth grow, unit vectors in the station's
/// frame, orthogonal at any state.
[[nodiscard]] Eigen::Matrix3d tether_axes_in_station(const TetherState& tether);

/// What (9)-(11) move per unit of length, elevation and azimuth, along `tether_axes_in_station`:
/// 1, l and l cos e. The Jacobian of (9)-(11) is axes * levers.asDiagonal(). The last lever is
/// negative beyond the zenith.
[[nodiscard]] Eigen::Vector3d tether_levers_m(const TetherState& tether);

/// Velocity of the drone in the station's frame under a command. Its yaw moves nothing.
[[nodiscard]] Eigen::Vector3d velocity_in_station_m_s(const TetherState& tether,
                                                      const TetherCommand& command);

/// What the azimuth does near the zenith, where no azimuth rate moves the drone sideways.
struct OverheadTurn {
  double within_m;    ///< level distance from the zenith within which it turns so
  double rate_rad_s;  ///< at the zenith
};

/// Rates that give a velocity: the inverse of the Jacobian. For elevation it is damped where the
/// tether is shorter than `damped_within_m` (Nakamura and Hanafusa 1986): l / (l^2 + d^2) with d^2
/// falling from (damped_within_m / 2)^2 at length 0 to 0 at `damped_within_m`, so that farther out
/// it is exact. The azimuth's share of it falls with the square of its lever within `overhead`,
/// where a turn takes over, which may for a while lead away from the velocity.
[[nodiscard]] TetherCommand rates_for_velocity(const TetherState& tether,
                                               const Eigen::Vector3d& velocity_in_station_m_s,
                                               double damped_within_m,
                                               const OverheadTurn& overhead);

/// Each rate within its own limit, and none that would carry length or elevation beyond its end:
/// a rate is at most (way left) / `braking_time_s`. Beyond an end 0 is always allowed.
[[nodiscard]] TetherCommand within_limits(const VehicleLimits& limits, const TetherState& tether,
                                          const TetherCommand& command);

}  // namespace stillkite
