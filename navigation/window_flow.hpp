#pragma once

#include <Eigen/Core>

namespace stillkite {

/// The flow that one window of the current frame saw, to be drawn.
struct WindowFlow {
  Eigen::Vector2f centre_px;
  Eigen::Vector2f flow_px;  ///< from the previous frame to this one
  float weight = 1;         ///< the robust estimator's, 1 an inlier, 0 an outlier
};

}  // namespace stillkite
