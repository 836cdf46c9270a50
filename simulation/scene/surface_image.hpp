#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

namespace stillkite {

/// What a made thing looks like from near: grain, tiles with joints, and marks (labels, stains,
/// lines of print) of all sizes on it. Lengths in texels, so it fits any size.
struct SurfaceStyle {
  double grey = 128;
  double grain_grey = 8;  ///< deviation, over a 1/f spectrum
  int tile_width = 0;     ///< 0: none
  int tile_height = 0;
  double tile_grey = 0;   ///< deviation between tiles
  double joint_grey = 0;  ///< of the joint, relative to the tiles
  double marks_a_megatexel = 0;
  double mark_size = 12;  ///< mean; many small, few large
  double mark_grey = 60;  ///< largest difference from the surface
};

/// CV_8UC1, the same for the same seed.
[[nodiscard]] cv::Mat surface_image(const SurfaceStyle& style, int width, int height,
                                    std::uint64_t seed);

}  // namespace stillkite
