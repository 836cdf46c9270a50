#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

namespace stillkite {

/// Pool of image buffers, reused once all other references are released. The pool belongs to one
/// thread; references may be held by others.
class ImagePool {
 public:
  /// Free buffer, or an empty image if all are in use.
  [[nodiscard]] cv::Mat take() const;

  /// Adds an image to the pool.
  void keep(const cv::Mat& image);

 private:
  std::vector<cv::Mat> images_;
};

}  // namespace stillkite
