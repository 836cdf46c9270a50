#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

namespace stillkite {

/// Images that are used again once nobody else holds them, so that a long video needs no more
/// memory than a short one. Used by one thread; the holders may be in others.
class ImagePool {
 public:
  /// An image that is free, or an empty one if all are held.
  [[nodiscard]] cv::Mat take() const;

  /// Remembers an image for later use.
  void keep(const cv::Mat& image);

 private:
  std::vector<cv::Mat> images_;
};

}  // namespace stillkite
