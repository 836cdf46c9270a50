#include "simulation/scene/repetitive_ground.hpp"

#include <algorithm>
#include <opencv2/core.hpp>

namespace stillkite {

cv::Mat repetitive_ground(const cv::Mat& image, int period, int max_side) {
  CV_Assert(image.type() == CV_8UC1 && period >= 4 && period % 2 == 0);
  const int half = period / 2;
  CV_Assert(image.cols > half && image.rows > half);
  const int side = std::max(1, (max_side - 1) / half) * half + 1;
  const auto folded = [&](int texel) {
    const int within = texel % period;
    return std::min(within, period - within);
  };
  cv::Mat ground(side, side, CV_8UC1);
  for (int row = 0; row < side; ++row) {
    const std::uint8_t* from = image.ptr(folded(row));
    std::uint8_t* to = ground.ptr(row);
    for (int column = 0; column < side; ++column) to[column] = from[folded(column)];
  }
  return ground;
}

}  // namespace stillkite
