#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace stillkite {

/// Drawing of a video's overlay: sizes are in units of `unit`, which grows with the image, so
/// that it looks the same at any resolution (1 px at 1280x720). Colours are BGR.
class OverlayCanvas {
 public:
  /// Draws on `image`, CV_8UC3, whose pixels it shares.
  explicit OverlayCanvas(cv::Mat image);

  [[nodiscard]] double unit() const { return unit_; }
  [[nodiscard]] cv::Size size() const { return image_.size(); }

  /// Darkens a rectangle so that text on it can be read.
  void panel(const cv::Rect2d& area);
  /// Text whose baseline starts at `at`; `height` is that of a capital.
  void text(const std::string& words, const cv::Point2d& at, double height,
            const cv::Scalar& colour, bool bold = false);
  /// A filled rounded rectangle with words in it.
  void pill(const std::string& words, const cv::Point2d& top_left, double height,
            const cv::Scalar& colour);
  /// An arrow with a dark rim.
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
