#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

namespace stillkite {

/// Image pyramid of factor 2; a pixel is the mean of 2x2 pixels of the finer level. Level 0 shares
/// the frame's pixels; the buffers of the other levels are reused.
class Pyramid {
 public:
  /// At most `levels` levels, none with fewer than `kMinSide_px` rows or columns.
  void build(const cv::Mat& grey, int levels);

  [[nodiscard]] int levels() const { return levels_; }
  [[nodiscard]] const cv::Mat& level(int i) const { return images_[static_cast<std::size_t>(i)]; }

  static constexpr int kMinSide_px = 48;

 private:
  std::vector<cv::Mat> images_;
  int levels_ = 0;
};

/// Number of levels that `Pyramid::build` creates for `max_levels`.
[[nodiscard]] int pyramid_levels(int width_px, int height_px, int max_levels);

}  // namespace stillkite
