#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "io/dataset/euroc_dataset.hpp"
#include "io/video/grey_depth.hpp"
#include "io/video/read_result.hpp"

namespace stillkite {

/// Reads image files as 8-bit grey images, rotated by their EXIF orientation as OpenCV's imread.
class ImageSequence {
 public:
  /// `bits`: significant (lowest) bits of 16-bit images; nullopt: all 16 (GreyDepth).
  ImageSequence(std::vector<StampedImage> images, std::optional<int> bits)
      : images_(std::move(images)), depth_(bits) {}

  /// Next image, stored in `recycled` if the size matches. Throws InputError if the image size or
  /// orientation changes, if the orientation is mirrored, or as GreyDepth.
  [[nodiscard]] ReadResult read(cv::Mat recycled);

  /// True if the first image was rotated, so that image rows are not sensor rows.
  [[nodiscard]] bool is_rotated() const { return orientation_.value_or(1) != 1; }

  [[nodiscard]] std::vector<Timestamp> stamps() const;
  [[nodiscard]] std::size_t count() const { return images_.size(); }

 private:
  void check_format(const StampedImage& image, cv::Size size, int orientation);

  std::vector<StampedImage> images_;
  GreyDepth depth_;
  std::size_t at_ = 0;
  cv::Size size_;
  std::optional<int> orientation_;    // EXIF, of the first image
  cv::Mat stored_;                    // before rotation
  cv::Mat deep_;                      // 16-bit image
  std::vector<unsigned char> bytes_;  // file content
};

}  // namespace stillkite
