#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

namespace stillkite {

/// Appearance of a man-made surface: grain, tiles with joints, and marks (labels, stains, print) of
/// all sizes. Lengths in texels, grey values in counts.
struct SurfaceStyle {
  double grey = 128;
  double grain_grey = 8;  ///< standard deviation, 1/f spectrum
  int tile_width = 0;     ///< 0: no tiles
  int tile_height = 0;
  double tile_grey = 0;   ///< standard deviation between tiles
  double joint_grey = 0;  ///< difference of the joints from the tiles
  double marks_a_megatexel = 0;
  double mark_size = 12;  ///< mean; many small, few large
  double mark_grey = 60;  ///< maximum difference from the surface
};

/// Texture image, CV_8UC1, deterministic in the seed.
[[nodiscard]] cv::Mat surface_image(const SurfaceStyle& style, int width, int height,
                                    std::uint64_t seed);

}  // namespace stillkite
