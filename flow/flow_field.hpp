#pragma once

#include <opencv2/core/mat.hpp>

namespace stillkite {

/// Optical flow on the grid of the previous frame: what is seen at pixel p in the previous frame is
/// seen at p + flow in the current one. Entry (row i, column j) belongs to
/// p = stride (j, i) + stride / 2, rounded down; with stride 1, one vector a pixel, p = (j, i).
///
/// The matrices are views of the buffers of whatever made them: they hold until its next call.
struct FlowField {
  cv::Mat flow_px;  ///< CV_32FC2 (x right, y down), finite everywhere

  /// CV_32FC1, what the image says about each vector: the smaller eigenvalue of the mean structure
  /// tensor of its window, (grey/px)^2, 0 where there is no texture. Empty: the method has none.
  cv::Mat information;
  int stride_px = 1;
};

}  // namespace stillkite
