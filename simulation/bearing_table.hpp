#pragma once

#include <array>
#include <vector>

#include "geometry/camera.hpp"

namespace stillkite {

/// Bearings along a piece of a row of samples, cubic in the distance t from its middle, in pixels:
/// x = x[0] + x[1] t + x[2] t^2 + x[3] t^3.
struct BearingSegment {
  static constexpr int kColumns = 32;

  std::array<float, 4> x{};
  std::array<float, 4> y{};
};

/// Bearings (x, y, 1) of all samples of a picture, `supersampling` a pixel and direction in even
/// distances. Through a wide-angle lens a cubic is within a hundredth of a pixel over a segment,
/// and sixteen times smaller than a table, which the memory cannot deliver fast enough. NaN where
/// the lens sees nothing in part of a segment.
struct BearingTable {
  int supersampling = 1;
  int segments_a_row = 0;
  std::vector<BearingSegment> segments;  ///< by rows of samples

  /// The segments of one row of samples: `sample_row` of a pixel's.
  [[nodiscard]] const BearingSegment* row(int pixel_row, int sample_row) const {
    return &segments[static_cast<std::size_t>(pixel_row * supersampling + sample_row) *
                     segments_a_row];
  }
};

/// Distance of a sample from its pixel's centre, in pixels.
[[nodiscard]] constexpr double sample_offset(int sample, int supersampling) {
  return (sample + 0.5) / supersampling - 0.5;
}

/// Throws InputError on a bad camera, or where `supersampling` is not 1 to 4.
[[nodiscard]] BearingTable tabulate_bearings(const Camera& camera, int supersampling);

}  // namespace stillkite
