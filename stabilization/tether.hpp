#pragma once

#include <Eigen/Core>

namespace stillkite {

/// Spherical coordinates of the drone in the station's frame (x ahead, y left, z up). The elevation
/// is in [0, pi], so that the azimuth is continuous across the zenith.
struct TetherState {
  double length_m = 0;
  double elevation_rad = 0;
  double azimuth_rad = 0;
};

/// Command to a tethered drone: rates of its three coordinates and of its own yaw (left is +).
struct TetherCommand {
  double length_rate_m_s = 0;
  double elevation_rate_rad_s = 0;
  double azimuth_rate_rad_s = 0;
  double yaw_rate_rad_s = 0;
};

/// Position from length, elevation and azimuth (hold paper, eq. 9-11).
[[nodiscard]] Eigen::Vector3d position_in_station(const TetherState& tether);

/// Inverse of `position_in_station`, on the branch of (elevation, azimuth) nearest to `near`. At
/// the zenith it keeps the azimuth of `near`, at length 0 also the elevation.
[[nodiscard]] TetherState tether_to(const Eigen::Vector3d& position_in_station_m,
                                    const TetherState& near);

}  // namespace stillkite
