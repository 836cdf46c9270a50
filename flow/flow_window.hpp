#pragma once

#include <Eigen/Core>

namespace stillkite {

/// What one window of the image tells about its motion from the previous frame to the current
/// one. Every flow method ends in these: a dense field sampled on a grid has unit information, a
/// window without texture has none.
struct FlowWindow {
  Eigen::Vector2f pixel;    ///< the window's centre in the previous frame
  Eigen::Vector2f flow_px;  ///< its displacement to the current frame

  /// Inverse covariance of the flow up to one common factor: the structure tensor G over the
  /// variance of the grey noise (1/px^2), of which a zero eigenvalue is a direction never seen.
  float information_xx = 1;
  float information_xy = 0;
  float information_yy = 1;
};

}  // namespace stillkite
