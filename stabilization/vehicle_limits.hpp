#pragma once

#include <numbers>

#include "geometry/fields.hpp"

namespace stillkite {

/// Limits of every command to the tethered drone.
struct VehicleLimits {
  double length_rate_m_s = 0.3;
  double elevation_rate_rad_s = 0.25;
  double azimuth_rate_rad_s = 0.2;
  double yaw_rate_rad_s = 0.4;
  double min_length_m = 0.5;
  double max_length_m = 20.0;
  double min_elevation_rad = 0.0;
  double braking_time_s = 2.0;

  [[nodiscard]] double max_elevation_rad() const { return std::numbers::pi - min_elevation_rad; }

  static void fields(auto& self, auto&& field) {
    field("length_rate_m_s", self.length_rate_m_s, Range{0, 5}, "limit of the tether length rate");
    field("elevation_rate_rad_s", self.elevation_rate_rad_s, Range{0, 5},
          "limit of the elevation rate");
    field("azimuth_rate_rad_s", self.azimuth_rate_rad_s, Range{0, 5}, "limit of the azimuth rate");
    field("yaw_rate_rad_s", self.yaw_rate_rad_s, Range{0, 5}, "limit of the yaw rate");
    field("min_length_m", self.min_length_m, Range{0.1, 1000}, "minimum tether length");
    field("max_length_m", self.max_length_m, Range{0.1, 1000}, "maximum tether length");
    field("min_elevation_rad", self.min_elevation_rad, Range{0, 1.5},
          "minimum elevation, on either side of the zenith");
    field("braking_time_s", self.braking_time_s, Range{0.1, 60},
          "time constant of the approach to an end of length or elevation; four times the drone's "
          "lag avoids overshoot");
  }
};

}  // namespace stillkite
