#pragma once

#include <vector>

#include "io/euroc_dataset.hpp"
#include "io/read_result.hpp"

namespace stillkite {

/// Reads pictures from files, as grey. A file's rotation mark is ignored, as in VideoReader.
class ImageSequence {
 public:
  explicit ImageSequence(std::vector<StampedImage> images) : images_(std::move(images)) {}

  /// The next picture, in `recycled` if that has its size. Throws InputError if the pictures change
  /// their size.
  [[nodiscard]] ReadResult read(cv::Mat recycled);

  [[nodiscard]] std::size_t count() const { return images_.size(); }

 private:
  std::vector<StampedImage> images_;
  std::size_t at_ = 0;
  cv::Size size_;
  std::vector<unsigned char> bytes_;  // of one file
};

}  // namespace stillkite
