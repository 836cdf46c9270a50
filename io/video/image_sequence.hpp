#pragma once

#include <optional>
#include <vector>

#include "io/dataset/euroc_dataset.hpp"
#include "io/video/grey_depth.hpp"
#include "io/video/read_result.hpp"

namespace stillkite {

/// Reads image files as 8-bit grey images. EXIF orientation is ignored.
class ImageSequence {
 public:
  /// `bits`: significant (lowest) bits of 16-bit images; nullopt: all 16 (GreyDepth).
  ImageSequence(std::vector<StampedImage> images, std::optional<int> bits)
      : images_(std::move(images)), depth_(bits) {}

  /// Next image, stored in `recycled` if the size matches. Throws InputError if the image size
  /// changes, or as GreyDepth.
  [[nodiscard]] ReadResult read(cv::Mat recycled);

  [[nodiscard]] std::size_t count() const { return images_.size(); }

 private:
  std::vector<StampedImage> images_;
  GreyDepth depth_;
  std::size_t at_ = 0;
  cv::Size size_;
  cv::Mat deep_;                      // 16-bit image
  std::vector<unsigned char> bytes_;  // file content
};

}  // namespace stillkite
