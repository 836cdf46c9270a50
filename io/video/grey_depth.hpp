#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>

namespace stillkite {

/// 16-bit samples with `depth` significant bits above `shift` unused ones.
struct SampleBits {
  int depth = 16;
  int shift = 0;
};

/// Converts images of more than 8 bits to 8 bits: grey = sample 2^(8 - bits - shift), rounded.
class GreyDepth {
 public:
  /// `bits`: significant (lowest) bits of the depth, as source.bits; nullopt: all.
  explicit GreyDepth(std::optional<int> bits) : bits_(bits) {}

  /// CV_8UC1 image, stored in `recycled` if it fits. Throws InputError with `name` if the image has
  /// fewer than `bits`, or if the first 16-bit image uses fewer than 15 and `bits` is not given.
  [[nodiscard]] cv::Mat to_8_bits(const cv::Mat& samples, const SampleBits& layout,
                                  const std::string& name, cv::Mat recycled);

  /// Throws InputError with `name` if `bits` are given, and the first image has 8 bits.
  void check_8_bits(const std::string& name) const;

 private:
  std::optional<int> bits_;
  bool checked_ = false;  // the first image
};

}  // namespace stillkite
