#pragma once

#include "geometry/fields.hpp"

namespace stillkite {

/// Options of FeatureTracker.
struct FeatureTrackerConfig {
  int levels = 4;
  int steps = 4;
  double min_correlation = 0.7;
  double forward_backward_px = 0.5;
  bool search = true;

  static void fields(auto& self, auto&& field) {
    field("levels", self.levels, Range{1, 8}, "number of pyramid levels");
    field("steps", self.steps, Range{1, 30}, "Lucas-Kanade iterations on the finest level");
    field("min_correlation", self.min_correlation, Range{-1, 1},
          "minimum normalized correlation of a feature's patch with its reference patch");
    field("forward_backward_px", self.forward_backward_px, kNonNegative,
          "maximum forward-backward error; 0: no forward-backward check");
    field("search", self.search, "register the whole image when most features are lost");
  }
};

/// Defaults: hold paper, section III.
struct OpenCvFeatureTrackerConfig {
  int window_px = 35;
  int max_level = 3;

  static void fields(auto& self, auto&& field) {
    field("window_px", self.window_px, Range{3, 99}, "side of the Lucas-Kanade integration window");
    field("max_level", self.max_level, Range{0, 8}, "coarsest pyramid level; 0 is full resolution");
  }
};

}  // namespace stillkite
