#pragma once

#include "geometry/fields.hpp"

namespace stillkite {

struct RotationGateConfig {
  double max_change_deg = 5;
  int max_consecutive_rejections = 3;

  static void fields(auto& self, auto&& field) {
    field("max_change_deg", self.max_change_deg, Range{0.01, 180},
          "maximum rotation from the last accepted frame");
    field("max_consecutive_rejections", self.max_consecutive_rejections, Range{0, 1000},
          "maximum number of consecutive rejections; the next frame is accepted");
  }
};

}  // namespace stillkite
