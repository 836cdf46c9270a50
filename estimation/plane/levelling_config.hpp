#pragma once

#include "geometry/fields.hpp"

namespace stillkite {

/// Correction of roll and pitch by the estimated normal of the ground plane.
struct LevellingConfig {
  bool enabled = true;
  double ground_slope_sigma_rad = 0.0005;

  static void fields(auto& self, auto&& field) {
    field("enabled", self.enabled, "correct roll and pitch by the normal of the ground plane");
    field("ground_slope_sigma_rad", self.ground_slope_sigma_rad, kNonNegative,
          "standard deviation of the ground slope within one image, rad");
  }
};

}  // namespace stillkite
