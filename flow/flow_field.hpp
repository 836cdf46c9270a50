#pragma once

#include <opencv2/core/mat.hpp>

namespace stillkite {

/// Optical flow on the pixel grid of the previous frame: pixel p corresponds to p + flow in the
/// current frame. Entry (row i, column j) is the flow at p = stride (j, i) + floor(stride / 2);
/// stride 1: one vector per pixel, p = (j, i).
///
/// The matrices are views of the estimator's buffers, valid until its next call.
struct FlowField {
  cv::Mat flow_px;  ///< CV_32FC2 (x right, y down), finite everywhere

  /// CV_32FC1: smaller eigenvalue of the window's mean structure tensor, (grey/px)^2; 0 without
  /// texture. Empty if the method does not compute it.
  cv::Mat information;
  int stride_px = 1;
};

}  // namespace stillkite
