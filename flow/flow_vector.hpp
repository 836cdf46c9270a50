#pragma once

#include <Eigen/Core>

namespace stillkite {

/// Optical flow of one tile with its information matrix: the common output of all flow methods.
/// Identity for methods without information, zero for a tile without texture.
struct FlowVector {
  Eigen::Vector2f pixel;    ///< centre of the tile in the previous frame
  Eigen::Vector2f flow_px;  ///< displacement to the current frame

  /// Inverse covariance of the flow up to a common factor, 1/px^2: structure tensor G / variance of
  /// the grey noise. A zero eigenvalue is an unobservable direction (aperture problem).
  float information_xx = 1;
  float information_xy = 0;
  float information_yy = 1;
};

}  // namespace stillkite
