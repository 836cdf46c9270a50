#pragma once

#include <optional>
#include <vector>

#include "io/dataset/euroc_dataset.hpp"
#include "io/video/read_result.hpp"

namespace stillkite {

/// Reads image files as 8-bit grey images. EXIF orientation is ignored.
class ImageSequence {
 public:
  /// `bits`: significant (lowest) bits of 16-bit images; nullopt: all 16.
  ImageSequence(std::vector<StampedImage> images, std::optional<int> bits)
      : images_(std::move(images)), bits_(bits) {}

  /// Next image, stored in `recycled` if the size matches. Throws InputError if the image size
  /// changes, or if 16-bit images use fewer than 15 bits and `bits` is not given.
  [[nodiscard]] ReadResult read(cv::Mat recycled);

  [[nodiscard]] std::size_t count() const { return images_.size(); }

 private:
  cv::Mat to_8_bits(const StampedImage& image, cv::Mat recycled);

  std::vector<StampedImage> images_;
  std::optional<int> bits_;  // significant bits of 16
  std::size_t at_ = 0;
  cv::Size size_;
  cv::Mat deep_;                      // 16-bit image
  std::vector<unsigned char> bytes_;  // file content
};

}  // namespace stillkite
