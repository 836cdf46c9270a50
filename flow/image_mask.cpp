#include "flow/image_mask.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "geometry/fields.hpp"

namespace stillkite {

ImageMask::ImageMask(const cv::Mat& valid_pixels) : valid_pixels_(valid_pixels) {
  if (valid_pixels.empty() || valid_pixels.type() != CV_8UC1) {
    throw InputError("image mask: give a non-empty 8-bit grey image");
  }
  cv::integral((valid_pixels == 0) / 255, masked_integral_, CV_32S);
}

double ImageMask::masked_ratio() const {
  return masked_integral_.at<int>(valid_pixels_.rows, valid_pixels_.cols) /
         static_cast<double>(valid_pixels_.total());
}

float ImageMask::masked_ratio(float x_px, float y_px, float width_px, float height_px) const {
  // pixel i covers [i - 0.5, i + 0.5]
  const auto border = [](float at, int size) {
    return static_cast<int>(std::lround(std::clamp(at + 0.5F, 0.0F, static_cast<float>(size))));
  };
  const int left = border(x_px - width_px / 2, valid_pixels_.cols);
  const int right = border(x_px + width_px / 2, valid_pixels_.cols);
  const int top = border(y_px - height_px / 2, valid_pixels_.rows);
  const int bottom = border(y_px + height_px / 2, valid_pixels_.rows);
  const int area = (right - left) * (bottom - top);
  if (area <= 0) return 1;
  const int masked = masked_integral_.at<int>(bottom, right) -
                     masked_integral_.at<int>(top, right) - masked_integral_.at<int>(bottom, left) +
                     masked_integral_.at<int>(top, left);
  return static_cast<float>(masked) / static_cast<float>(area);
}

}  // namespace stillkite
