#pragma once

#include <array>
#include <vector>

#include "geometry/camera.hpp"
#include "simulation/render/lens_error.hpp"

namespace stillkite {

/// Bearings of a segment of a row of samples, cubic in the distance t (pixels) from its centre:
/// x = x[0] + x[1] t + x[2] t^2 + x[3] t^3.
struct BearingSegment {
  static constexpr int kColumns = 32;

  std::array<float, 4> x{};
  std::array<float, 4> y{};
};

/// Bearings (x, y, 1) of all samples of an image, supersampling^2 samples per pixel. For a
/// wide-angle lens the error of the cubic is below 0.01 px. A table of all bearings would be 16
/// times larger and limited by memory bandwidth. A segment is NaN if part of it is outside the
/// lens's field of view.
struct BearingTable {
  int supersampling = 1;
  int segments_a_row = 0;
  std::vector<BearingSegment> segments;  ///< by pixel row, sample, column

  [[nodiscard]] int samples_a_pixel() const { return supersampling * supersampling; }
  /// Segments of a pixel row for one sample.
  [[nodiscard]] const BearingSegment* row(int pixel_row, int sample) const {
    return &segments[static_cast<std::size_t>(pixel_row * samples_a_pixel() + sample) *
                     segments_a_row];
  }
};

/// Offset of a sample from its pixel's centre, in pixels.
struct SampleOffset {
  double right = 0;
  double down = 0;
};

/// Rotated grid without two samples in one row or column (n rooks: Shirley 1991, "Discrepancy as a
/// quality measure for sample distributions"). A moving horizontal or vertical edge crosses the
/// samples one by one at equal spacing.
[[nodiscard]] constexpr SampleOffset sample_offset(int sample, int supersampling) {
  const int row = sample / supersampling;
  const int column = sample % supersampling;
  const double samples = supersampling * supersampling;
  return {.right = (supersampling * (column + 1) - row - 0.5) / samples - 0.5,
          .down = (supersampling * row + column + 0.5) / samples - 0.5};
}

/// Samples per pixel and direction.
inline constexpr int kMaxSupersampling = 4;

/// Throws InputError for an invalid camera or a `supersampling` outside 1 to 4.
void check_rendering(const Camera& camera, int supersampling);

/// Calls check_rendering.
[[nodiscard]] BearingTable tabulate_bearings(const Camera& camera, const LensError& lens_error,
                                             int supersampling);

}  // namespace stillkite
