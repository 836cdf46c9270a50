#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace stillkite {

/// Drawing functions of the overlay. Lengths are in `unit`, which scales with the image (1 px at
/// 1280x720). Colours are BGR.
class OverlayCanvas {
 public:
  /// Draws into the pixels of `image`, CV_8UC3.
  explicit OverlayCanvas(cv::Mat image);

  [[nodiscard]] double unit() const { return unit_; }
  [[nodiscard]] cv::Size size() const { return image_.size(); }

  /// Darkens a rectangle, as text background.
  void panel(const cv::Rect2d& area);
  /// Text with its baseline starting at `at`; `height`: cap height.
  void text(const std::string& words, const cv::Point2d& at, double height,
            const cv::Scalar& colour, bool bold = false);
  /// Filled rounded rectangle with text.
  void pill(const std::string& words, const cv::Point2d& top_left, double height,
            const cv::Scalar& colour);
  /// Arrow with a dark outline.
  void arrow(const cv::Point2d& from, const cv::Point2d& to, double width,
             const cv::Scalar& colour);
  void dot(const cv::Point2d& centre, double radius, const cv::Scalar& colour);
  void ring(const cv::Point2d& centre, double radius, double width, const cv::Scalar& colour);
  void line(const cv::Point2d& from, const cv::Point2d& to, double width, const cv::Scalar& colour);

 private:
  [[nodiscard]] int pixels(double units) const;

  cv::Mat image_;
  double unit_;
};

}  // namespace stillkite
