#pragma once

#include <Eigen/Core>

namespace stillkite {

/// Where the drone is to be kept from now on, level, in the station's frame.
struct LevelWay {
  Eigen::Vector2d now_m;
  Eigen::Vector2d drift_m_s;
};

/// How the azimuth follows what it is told.
struct AzimuthDrive {
  double rate_limit_rad_s;
  double lag_s;
};

/// The azimuth rate to begin with so that for `horizon_s` the tether's vertical plane passes as
/// near to that way as it can, in the mean of squares; the elevation then moves the drone within
/// the plane, also across the zenith. Near overhead, where the way asks for more than the azimuth
/// can turn, this tells whether to turn with it or to let it pass on the other side: the rate holds
/// for a sixteenth of the horizon, and then the plane turns after the way as fast as it can, to
/// either side (predictive control; docs/hold_controller.md).
/// 0 for a way that is not finite.
[[nodiscard]] double azimuth_to_displacement_rad_s(double azimuth_rad, const LevelWay& way,
                                                   const AzimuthDrive& drive, double horizon_s);

}  // namespace stillkite
