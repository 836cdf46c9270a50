#pragma once

#include <Eigen/Core>

namespace stillkite {

/// Flow of one tile or feature of the current frame, for drawing.
struct WeightedFlow {
  Eigen::Vector2f centre_px;  ///< in the current frame
  Eigen::Vector2f flow_px;    ///< tile: since the previous frame; feature: since the reference
  float weight = 1;           ///< of the robust estimator: 1 inlier, 0 outlier
};

}  // namespace stillkite
