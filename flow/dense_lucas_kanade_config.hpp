#pragma once

#include "geometry/fields.hpp"

namespace stillkite {

struct DenseLucasKanadeConfig {
  int window_px = 21;
  int levels = 5;
  int steps = 2;
  int finest_steps = 1;
  double regularisation = 2.0;

  static void fields(auto& self, auto&& field) {
    field("window_px", self.window_px, Range{3, 63}, "side of the square integration window, odd");
    field("levels", self.levels, Range{1, 10}, "maximum number of pyramid levels");
    field("steps", self.steps, Range{1, 20}, "Gauss-Newton iterations on each coarse level");
    field("finest_steps", self.finest_steps, Range{1, 20},
          "Gauss-Newton iterations at full resolution");
    field("regularisation", self.regularisation, kPositive,
          "Tikhonov term of the mean structure tensor at full resolution, (grey/px)^2; a quarter "
          "of it "
          "on each coarser level");
  }
};

}  // namespace stillkite
