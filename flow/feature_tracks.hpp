#pragma once

#include <Eigen/Core>
#include <vector>

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

/// Positions of the reference features in the current image, in the order of the reference.
struct FeatureTracks {
  std::vector<Eigen::Vector2f> reference_px;
  std::vector<Eigen::Vector2f> current_px;
  std::vector<unsigned char> found;  ///< 1 where `current_px` is valid
  /// Covariance of `current_px` from the patch residual under white pixel noise. Optimistic after
  /// JPEG: errors are 1 to 1.6 sigma (bench_feature_error). Empty if the method has no covariance.
  std::vector<Eigen::Matrix2f> covariance_px2;
  int found_count = 0;
};

}  // namespace stillkite
