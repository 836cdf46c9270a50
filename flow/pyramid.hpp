#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

namespace stillkite {

/// Grey images, each level half the size of the one before; a pixel is the mean of 2x2.
/// Level 0 shares the frame's pixels, the buffers of the others are kept from frame to frame.
class Pyramid {
 public:
  /// Stops early where a level would have fewer than `kSmallestSide_px` rows or columns.
  void build(const cv::Mat& grey, int levels);

  [[nodiscard]] int levels() const { return levels_; }
  [[nodiscard]] const cv::Mat& level(int i) const { return images_[static_cast<std::size_t>(i)]; }

  static constexpr int kSmallestSide_px = 48;

 private:
  std::vector<cv::Mat> images_;
  int levels_ = 0;
};

/// How many levels `Pyramid::build` makes of an image when asked for `wanted`.
[[nodiscard]] int pyramid_levels(int width_px, int height_px, int wanted);

}  // namespace stillkite
