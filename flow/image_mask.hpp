#pragma once

#include <opencv2/core/mat.hpp>

namespace stillkite {

/// Mask of static overlays and airframe in view: pixels that do not show the scene.
class ImageMask {
 public:
  /// `valid_pixels`: CV_8UC1 of the image's size, 0 where masked; pixels are shared, not copied.
  /// Throws InputError if it is empty or of another type.
  explicit ImageMask(const cv::Mat& valid_pixels);

  [[nodiscard]] const cv::Mat& valid_pixels() const { return valid_pixels_; }
  /// Masked ratio of the whole image, in [0, 1].
  [[nodiscard]] double masked_ratio() const;
  /// Masked ratio of a rectangle about a point, clipped to the image; 1 if it lies outside.
  [[nodiscard]] float masked_ratio(float x_px, float y_px, float width_px, float height_px) const;

 private:
  cv::Mat valid_pixels_;
  cv::Mat masked_integral_;  // integral image of the masked pixels, CV_32S
};

}  // namespace stillkite
