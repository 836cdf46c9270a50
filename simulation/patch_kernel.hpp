#pragma once

#include <array>
#include <cstdint>

#include "simulation/ground_texture.hpp"

namespace stillkite {

/// A patch as one camera sees it; every array times the bearing b = (x, y, 1). The point seen along
/// b is at depth 1 / (inverse_depth . b) and texel (u . b, v . b) / (inverse_depth . b).
struct PatchView {
  std::array<float, 3> inverse_depth{};  ///< > 0 in front of the camera
  std::array<float, 3> u{};
  std::array<float, 3> v{};
  float width_texels = 0;  ///< of the rectangle, which may be more than the picture's
  float height_texels = 0;
  float texels_per_cubed_depth = 0;  ///< a sample covers depth^3 times this, in texels of area
  bool mirrored = false;             ///< the rectangle is larger than the picture
  const std::uint32_t* words = nullptr;
  const GroundTexture::Level* levels = nullptr;
  int level_count = 1;
};

/// A few rows of neighbouring pixels and the patches that may be seen there.
struct PatchTile {
  const PatchView* const* candidates = nullptr;
  int candidate_count = 0;
  bool covered = false;  ///< by its only candidate
  float background_grey = 0;
  int columns = 0;  ///< a multiple of kTilePadding
  int samples = 0;
  bool even_y = false;  ///< y of a sample is one value a row
};
inline constexpr int kTilePadding = 16;

/// Bearings of one row of a tile: a pointer a sample.
struct PatchTileRow {
  const float* const* x = nullptr;
  const float* const* y = nullptr;
  float* grey = nullptr;  ///< to which the samples' values are added
};

/// With the widest vector instructions of this processor, chosen at run time.
void add_tile_row(const PatchTile& tile, const PatchTileRow& row);

}  // namespace stillkite
