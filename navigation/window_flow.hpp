#pragma once

#include <Eigen/Core>

namespace stillkite {

/// The flow that one window, or one feature, of the current frame saw, to be drawn.
struct WindowFlow {
  Eigen::Vector2f centre_px;
  Eigen::Vector2f
      flow_px;       ///< a window's since the previous frame, a feature's since the reference
  float weight = 1;  ///< the robust estimator's, 1 an inlier, 0 an outlier
};

}  // namespace stillkite
