#pragma once

#include <Eigen/Core>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "flow/frame.hpp"

namespace stillkite {

/// Detects static overlays and airframe in view: text, landing gear, dirt on the lens. Criterion:
/// edges that repeatedly stay at the same pixel while the image moves
/// (docs/inputs_and_calibration.md).
class StaticOverlayDetector {
 public:
  /// Returns the frame with the detected overlays added to its mask.
  [[nodiscard]] Frame masked(Frame frame);

  /// Processes one frame. `shift_px`: mean image displacement since the previous frame; empty if
  /// unknown, which restarts the comparison.
  void update(const cv::Mat& grey, const std::optional<Eigen::Vector2d>& shift_px);

 private:
  void count_static_edges();
  [[nodiscard]] cv::Mat static_cells() const;

  // half resolution: the current image and the one it is compared with
  cv::Mat current_half_, reference_half_;
  Eigen::Vector2d accumulated_shift_px_ = Eigen::Vector2d::Zero();
  cv::Mat static_counts_;  // CV_8U: number of comparisons in which the pixel was static
  cv::Mat overlay_cells_;  // CV_8U: 255 where an overlay is detected
  bool has_overlays_ = false;
  // mask of the last frame and its union with the overlays, cached
  std::shared_ptr<const ImageMask> input_mask_, combined_mask_;
};

}  // namespace stillkite
