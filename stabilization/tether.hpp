#pragma once

#include <Eigen/Core>

namespace stillkite {

/// The drone seen from its station, in the station's frame (x ahead, y left, z up). The elevation
/// runs from 0 to pi, so that the azimuth stays continuous across the zenith.
struct TetherState {
  double length_m = 0;
  double elevation_rad = 0;
  double azimuth_rad = 0;
};

/// What a tethered drone obeys: rates of its three coordinates, and of its own yaw (left is +).
struct TetherCommand {
  double length_rate_m_s = 0;
  double elevation_rate_rad_s = 0;
  double azimuth_rate_rad_s = 0;
  double yaw_rate_rad_s = 0;
};

/// Hold paper, eq. (9)-(11).
[[nodiscard]] Eigen::Vector3d position_in_station(const TetherState& tether);

/// The inverse, on the branch of (elevation, azimuth) that is nearest to `near`: at the zenith and
/// at length 0 the azimuth of `near` is kept.
[[nodiscard]] TetherState tether_to(const Eigen::Vector3d& position_in_station_m,
                                    const TetherState& near);

}  // namespace stillkite
