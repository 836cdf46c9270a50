#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

namespace stillkite {

/// Pictures that are used again once nobody else holds them, so that a long video needs no more
/// memory than a short one. Used by one thread; the holders may be in others.
class PicturePool {
 public:
  /// A picture that is free, or an empty one if all are held.
  [[nodiscard]] cv::Mat take() const;

  /// Remembers a picture for later use.
  void keep(const cv::Mat& picture);

 private:
  std::vector<cv::Mat> pictures_;
};

}  // namespace stillkite
