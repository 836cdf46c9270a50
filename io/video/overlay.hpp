#pragma once

#include <opencv2/core/mat.hpp>
#include <span>

#include "geometry/camera.hpp"
#include "geometry/rigid_transform.hpp"
#include "navigation/navigation_estimate.hpp"
#include "navigation/weighted_flow.hpp"

namespace stillkite {

/// Text drawn on the image: verdict and numbers, or none.
enum class OverlayText { figures, none };

/// Overlay of a video: flow vectors (thin arrows; outliers red), image-plane velocity (thick
/// arrow), focus of expansion (winged ring), horizon, nadir, verdict and numbers. One object per
/// video: it reuses its buffer and scales the velocity arrow by the maximum speed so far.
class Overlay {
 public:
  Overlay(const Camera& camera, const RigidTransform& body_from_camera,
          OverlayText text = OverlayText::figures);

  /// Size of the drawn images: even; small frames are enlarged by an integer factor.
  [[nodiscard]] cv::Size size() const { return size_; }

  /// Draws on `grey`, the frame of the estimate (CV_8UC1). The returned CV_8UC3 image is valid
  /// until the next call.
  [[nodiscard]] const cv::Mat& draw(const cv::Mat& grey, const NavigationEstimate& estimate,
                                    std::span<const WeightedFlow> flow_vectors);

 private:
  void paint_background(const cv::Mat& grey);

  Camera camera_;
  RigidTransform body_from_camera_;
  OverlayText text_;
  int zoom_;
  cv::Size size_;
  cv::Mat image_;
  double max_speed_m_s_ = 0;
};

}  // namespace stillkite
