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

/// Bearings (x, y, 1) of all samples of an image, as many a pixel as the square of
/// `supersampling`. Through a wide-angle lens a cubic is within a hundredth of a pixel over a
/// segment, and sixteen times smaller than a table, which the memory cannot deliver fast enough.
/// NaN where the lens sees nothing in part of a segment.
struct BearingTable {
  int supersampling = 1;
  int segments_a_row = 0;
  std::vector<BearingSegment> segments;  ///< by rows of pixels, then samples of a pixel

  [[nodiscard]] int samples_a_pixel() const { return supersampling * supersampling; }
  /// The segments of a row, for one of the samples of its pixels.
  [[nodiscard]] const BearingSegment* row(int pixel_row, int sample) const {
    return &segments[static_cast<std::size_t>(pixel_row * samples_a_pixel() + sample) *
                     segments_a_row];
  }
};

/// Of a sample from its pixel's centre, in pixels.
struct SampleOffset {
  double right = 0;
  double down = 0;
};

/// A grid turned so far that no two samples share a row or a column: an upright or level edge that
/// moves on by a pixel passes them one by one, evenly (n rooks: Shirley 1991, "Discrepancy as a
/// quality measure for sample distributions").
[[nodiscard]] constexpr SampleOffset sample_offset(int sample, int supersampling) {
  const int row = sample / supersampling;
  const int column = sample % supersampling;
  const double samples = supersampling * supersampling;
  return {.right = (supersampling * (column + 1) - row - 0.5) / samples - 0.5,
          .down = (supersampling * row + column + 0.5) / samples - 0.5};
}

/// Throws InputError on a bad camera, or where `supersampling` is not 1 to 4.
[[nodiscard]] BearingTable tabulate_bearings(const Camera& camera, int supersampling);

}  // namespace stillkite
