#pragma once

#include <optional>

#include "geometry/angle.hpp"
#include "geometry/fields.hpp"
#include "stabilization/tether.hpp"

namespace stillkite {

/// Constant state of a taut tether, for recordings without one.
struct NominalTetherConfig {
  double length_m = 5;
  double elevation_deg = 45;
  double azimuth_deg = 0;

  [[nodiscard]] TetherState state() const {
    return {length_m, elevation_deg * kDegree, azimuth_deg * kDegree};
  }

  static void fields(auto& self, auto&& field) {
    field("length_m", self.length_m, Range{0.1, 1000},
          "tether length from the station to the drone");
    field("elevation_deg", self.elevation_deg, Range{0, 180},
          "elevation above the station's horizontal plane; near 90 the azimuth has no effect");
    field("azimuth_deg", self.azimuth_deg, Range{-180, 180},
          "azimuth relative to the heading of the first frame, positive left");
  }
};

/// Controller in shadow mode: computes commands for a recording; none is flown.
struct ShadowConfig {
  std::optional<bool> enabled;
  NominalTetherConfig tether;

  static void fields(auto& self, auto&& field) {
    field("enabled", self.enabled,
          "write the controller's commands to commands.csv; null: true unless estimator.policy is "
          "flow");
    field("tether", self.tether, "nominal tether");
  }
};

}  // namespace stillkite
