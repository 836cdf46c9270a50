#pragma once

#include "geometry/fields.hpp"

namespace stillkite {

struct MotionFilterConfig {
  double acceleration_density = 0.2;
  double angular_acceleration_density = 0.3;

  static void fields(auto& self, auto&& field) {
    field("acceleration_density", self.acceleration_density, Range{1e-9, 1e9},
          "noise density of the linear acceleration, m/s^2/sqrt(Hz)");
    field("angular_acceleration_density", self.angular_acceleration_density, Range{1e-9, 1e9},
          "noise density of the angular acceleration, rad/s^2/sqrt(Hz)");
  }
};

}  // namespace stillkite
