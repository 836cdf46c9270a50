#pragma once

#include <optional>
#include <vector>

#include "io/dataset/euroc_dataset.hpp"
#include "io/video/read_result.hpp"

namespace stillkite {

/// Reads images from files, as grey of 8 bits. A file's rotation mark is ignored.
class ImageSequence {
 public:
  /// Of images of 16 bits a pixel the lowest `bits` are used; without a word of it all of them.
  ImageSequence(std::vector<StampedImage> images, std::optional<int> bits)
      : images_(std::move(images)), bits_(bits) {}

  /// The next image, in `recycled` if that has its size. Throws InputError if the images change
  /// their size, or seem to use fewer bits than they are told to.
  [[nodiscard]] ReadResult read(cv::Mat recycled);

  [[nodiscard]] std::size_t count() const { return images_.size(); }

 private:
  cv::Mat to_8_bits(const StampedImage& image, cv::Mat recycled);

  std::vector<StampedImage> images_;
  std::optional<int> bits_;  // that are used, of 16
  std::size_t at_ = 0;
  cv::Size size_;
  cv::Mat deep_;                      // an image of 16 bits
  std::vector<unsigned char> bytes_;  // of one file
};

}  // namespace stillkite
