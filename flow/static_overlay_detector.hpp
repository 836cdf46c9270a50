#pragma once

#include <Eigen/Core>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "flow/frame.hpp"

namespace stillkite {

/// Finds what is fixed to the camera and no part of the world: text burnt into the image, the
/// aircraft's legs, dirt on the lens. It keeps its place to a fraction of a pixel again and again
/// while the rest of the image moves (docs/fixtures.md).
class StaticOverlayDetector {
 public:
  /// The frame with all that was found so far hidden as well.
  [[nodiscard]] Frame masked(Frame frame);

  /// Frame by frame. `shift_px`: of the image as a whole since the frame before; nothing where
  /// that is not known.
  void learn(const cv::Mat& grey, const std::optional<Eigen::Vector2d>& shift_px);

 private:
  void count_still();
  [[nodiscard]] cv::Mat fixed_cells() const;

  // half the image's size: the one at hand and the one that it is compared with
  cv::Mat half_, before_;
  Eigen::Vector2d since_then_px_ = Eigen::Vector2d::Zero();
  cv::Mat counts_;  // CV_8U: in how many comparisons each of its pixels has kept still
  cv::Mat cells_;   // CV_8U: 255 where something is fixed
  bool has_overlays_ = false;
  // together, for as long as neither changes
  std::shared_ptr<const ImageMask> given_, combined_;
};

}  // namespace stillkite
