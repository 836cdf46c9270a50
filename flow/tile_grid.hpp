#pragma once

#include <vector>

namespace stillkite {

/// Regular grid of tiles over an image, padded with empty tiles to a multiple of `kPadding`: SIMD
/// code needs no remainder loop.
struct TileGrid {
  static constexpr int kPadding = 16;
  /// Interpolation margin: left and above, right and below.
  static constexpr int kBefore_px = 2;
  static constexpr int kAfter_px = 3;
  static constexpr int kMaxRows = 24;

  int columns = 0;  ///< width of a tile, px: 16 or 32
  int rows = 0;     ///< height of a tile, px: at most `kMaxRows`
  int count = 0;    ///< number of tiles including padding
  std::vector<int> left_px, top_px;
  std::vector<float> centre_x_px, centre_y_px;
};

/// Centred grid of the complete tiles inside the interpolation margin.
[[nodiscard]] TileGrid make_tile_grid(int width_px, int height_px, int columns_per_tile,
                                      int rows_per_tile);

}  // namespace stillkite
