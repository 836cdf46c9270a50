#pragma once

#include <opencv2/core/mat.hpp>

namespace stillkite {

/// Which part of the camera's image shows no world: text burnt in, the aircraft's own legs.
class ImageMask {
 public:
  /// CV_8UC1 of the image's size, 0 where no world is shown; the pixels are shared, not copied.
  /// InputError if it is another type.
  explicit ImageMask(const cv::Mat& shows_world);

  [[nodiscard]] const cv::Mat& shows_world() const { return shows_world_; }
  /// Of the whole image.
  [[nodiscard]] double hidden_ratio() const;
  /// Of the part of a window about a point that lies in the image; 1 where none does.
  [[nodiscard]] float hidden_ratio(float x_px, float y_px, float width_px, float height_px) const;

 private:
  cv::Mat shows_world_;
  cv::Mat hidden_;  // how many pixels left of and above: CV_32S, a row and a column more
};

}  // namespace stillkite
