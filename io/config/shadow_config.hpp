#pragma once

#include <optional>

#include "geometry/angle.hpp"
#include "geometry/fields.hpp"
#include "stabilization/tether.hpp"

namespace stillkite {

/// A tether that a recording does not have: taut, and always the same.
struct NominalTetherConfig {
  double length_m = 5;
  double elevation_deg = 45;
  double azimuth_deg = 0;

  [[nodiscard]] TetherState state() const {
    return {length_m, elevation_deg * kDegree, azimuth_deg * kDegree};
  }

  static void fields(auto& self, auto&& field) {
    field("length_m", self.length_m, Range{0.1, 1000}, "from the station to the drone");
    field("elevation_deg", self.elevation_deg, Range{0, 180},
          "over the station's level; near 90 the azimuth moves nothing");
    field("azimuth_deg", self.azimuth_deg, Range{-180, 180},
          "from the heading of the first frame, left is +");
  }
};

/// The controller beside a recording: it commands, nothing is flown.
struct ShadowConfig {
  std::optional<bool> enabled;
  NominalTetherConfig tether;

  static void fields(auto& self, auto&& field) {
    field("enabled", self.enabled,
          "the controller says in commands.csv what it would command; null: unless the policy is "
          "flow");
    field("tether", self.tether, "the tether that the drone is taken to hang on");
  }
};

}  // namespace stillkite
