#pragma once

#include <cstddef>
#include <vector>

#include "geometry/camera.hpp"

namespace stillkite {

/// Bearings (x, y) of the samples of a picture, `supersampling` squared a pixel in even distances,
/// sample by sample from the pixel's upper left. NaN where the lens sees nothing.
struct SampleBearings {
  static constexpr int kMaxSamples = 16;

  int supersampling = 1;  ///< samples a pixel and direction
  int samples = 1;        ///< a pixel
  int padded_width = 0;
  bool separable = false;  ///< a pinhole's: x is the same in all rows, y within one
  std::vector<float> x;
  std::vector<float> y;

  /// `padded_width` values, for the pixels of a row.
  [[nodiscard]] const float* x_row(int row, int sample) const;
  /// The same, but a single value where separable.
  [[nodiscard]] const float* y_row(int row, int sample) const;
};

/// Rows are padded to a multiple of `padding`. Throws InputError on a bad camera, or where
/// `supersampling` is not 1 to 4.
[[nodiscard]] SampleBearings tabulate_bearings(const Camera& camera, int supersampling,
                                               int padding);

}  // namespace stillkite
