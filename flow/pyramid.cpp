#include "flow/pyramid.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace stillkite {

int pyramid_levels(int width_px, int height_px, int max_levels) {
  int levels = 1;
  int side = std::min(width_px, height_px) / 2;
  while (levels < max_levels && side >= Pyramid::kMinSide_px) {
    ++levels;
    side /= 2;
  }
  return levels;
}

void Pyramid::build(const cv::Mat& grey, int levels) {
  levels_ = pyramid_levels(grey.cols, grey.rows, levels);
  images_.resize(std::max(images_.size(), static_cast<std::size_t>(levels_)));
  images_[0] = grey;
  for (int i = 1; i < levels_; ++i) {
    const cv::Mat& fine = level(i - 1);
    const cv::Size half(fine.cols / 2, fine.rows / 2);
    // crops an odd last row or column: every pixel is the mean of exactly 2x2
    const cv::Mat even = fine(cv::Rect(0, 0, 2 * half.width, 2 * half.height));
    cv::resize(even, images_[static_cast<std::size_t>(i)], half, 0, 0, cv::INTER_AREA);
  }
}

}  // namespace stillkite
