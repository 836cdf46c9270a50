#pragma once

#include <Eigen/Core>

namespace stillkite {

/// Target of the drone in the horizontal plane of the station's frame; constant velocity.
struct HorizontalTarget {
  Eigen::Vector2d position_m;
  Eigen::Vector2d velocity_m_s;
};

/// Response of the azimuth rate to its command: rate limit and first-order lag.
struct AzimuthDynamics {
  double rate_limit_rad_s;
  double lag_s;
};

/// Azimuth rate, rad/s, that minimizes the mean squared distance of the target from the tether's
/// vertical plane over `horizon_s` (predictive control; docs/hold_control.md). Elevation moves
/// the drone within that plane, across the zenith if necessary. The rate is constant for the first
/// sixteenth of the horizon; then the plane rotates towards the target at the rate limit, in either
/// direction. So the azimuth follows a target that passes the zenith at a large distance, and a
/// closer one passes on the other side. Returns 0 for a target that is not finite.
[[nodiscard]] double azimuth_to_displacement_rad_s(double azimuth_rad,
                                                   const HorizontalTarget& target,
                                                   const AzimuthDynamics& dynamics,
                                                   double horizon_s);

}  // namespace stillkite
