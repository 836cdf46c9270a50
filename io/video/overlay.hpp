#pragma once

#include <opencv2/core/mat.hpp>
#include <span>

#include "geometry/camera.hpp"
#include "geometry/rigid_transform.hpp"
#include "navigation/navigation_estimate.hpp"
#include "navigation/window_flow.hpp"

namespace stillkite {

/// What was seen and concluded, drawn over the frames of one video: flow of the windows (thin
/// arrows; outliers red), the velocity as the image shows it (thick arrow, and a winged ring
/// where the camera flies to), horizon, nadir, verdict and figures. One object a video: its buffer
/// is kept, and the velocity arrow's scale follows the fastest frame so far.
class Overlay {
 public:
  Overlay(const Camera& camera, const RigidTransform& body_from_camera);

  /// Of the drawn images: even, small frames are enlarged by a whole factor.
  [[nodiscard]] cv::Size size() const { return size_; }

  /// `grey`: the frame of the estimate, CV_8UC1. The image, CV_8UC3, is valid until the next
  /// call.
  [[nodiscard]] const cv::Mat& draw(const cv::Mat& grey, const NavigationEstimate& estimate,
                                    std::span<const WindowFlow> windows);

 private:
  void paint_background(const cv::Mat& grey);

  Camera camera_;
  RigidTransform body_from_camera_;
  int zoom_;
  cv::Size size_;
  cv::Mat image_;
  double fastest_m_s_ = 0;
};

}  // namespace stillkite
