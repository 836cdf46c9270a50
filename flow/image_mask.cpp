#include "flow/image_mask.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "geometry/fields.hpp"

namespace stillkite {

ImageMask::ImageMask(const cv::Mat& shows_world) : shows_world_(shows_world) {
  if (shows_world.empty() || shows_world.type() != CV_8UC1) {
    throw InputError("image mask: it must be an image of one byte a pixel");
  }
  cv::integral((shows_world == 0) / 255, hidden_, CV_32S);
}

double ImageMask::hidden_ratio() const {
  return hidden_.at<int>(shows_world_.rows, shows_world_.cols) /
         static_cast<double>(shows_world_.total());
}

float ImageMask::hidden_ratio(float x_px, float y_px, float width_px, float height_px) const {
  // pixel i lies between i - 0.5 and i + 0.5
  const auto border = [](float at, int size) {
    return static_cast<int>(std::lround(std::clamp(at + 0.5F, 0.0F, static_cast<float>(size))));
  };
  const int left = border(x_px - width_px / 2, shows_world_.cols);
  const int right = border(x_px + width_px / 2, shows_world_.cols);
  const int top = border(y_px - height_px / 2, shows_world_.rows);
  const int bottom = border(y_px + height_px / 2, shows_world_.rows);
  const int area = (right - left) * (bottom - top);
  if (area <= 0) return 1;
  const int hidden = hidden_.at<int>(bottom, right) - hidden_.at<int>(top, right) -
                     hidden_.at<int>(bottom, left) + hidden_.at<int>(top, left);
  return static_cast<float>(hidden) / static_cast<float>(area);
}

}  // namespace stillkite
