#pragma once

#include <array>
#include <cstdint>

#include "simulation/render/bearing_table.hpp"
#include "simulation/scene/ground_texture.hpp"

namespace stillkite {

/// One pyramid level of a patch's texture: level coordinate = scale x finest coordinate + shift.
struct PatchLevel {
  float scale = 1;
  float shift = 0;
  float last_u = 0;  ///< coordinates of the level's last texel
  float last_v = 0;
  std::uint32_t pitch = 0;   ///< bytes per row
  std::uint32_t offset = 0;  ///< bytes from the first texel of the pyramid to that of the level
};

/// Projection of a patch into one camera; linear functions of the bearing b = (x, y, 1). The point
/// along b has depth 1 / (inverse_depth . b) and texel (u . b, v . b) / (inverse_depth . b).
struct PatchView {
  std::array<float, 3> inverse_depth{};  ///< > 0 in front of the camera
  std::array<float, 3> u{};
  std::array<float, 3> v{};
  float width_texels = 0;  ///< rectangle size; may exceed the texture size
  float height_texels = 0;
  float texels_per_cubed_depth = 0;     ///< footprint of a pixel / depth^3, in square texels
  bool mirrored = false;                ///< rectangle larger than its texture
  const std::uint8_t* pairs = nullptr;  ///< GroundTexture::pairs
  int level_count = 1;
  std::array<PatchLevel, 12> levels{};
};

/// Potentially visible patch with bounds of its inverse depth.
struct PatchCandidate {
  const PatchView* view = nullptr;
  float min_inverse_depth = 0;  ///< <= 0: unbounded depth
  float max_inverse_depth = 0;
};

/// One sample per pixel of a rectangle of pixels, with the patches that may be visible there.
struct PatchTile {
  static constexpr int kRows = 16;  ///< maximum

  const PatchCandidate* candidates = nullptr;
  int candidate_count = 0;
  bool covered = false;  ///< the only candidate fills the tile
  float background_grey = 0;
  int rows = 0;
  const BearingSegment* const* segments = nullptr;  ///< one per row
  float offset = 0;       ///< horizontal offset of the sample from the pixel centre, in pixels
  float round_up = 0;     ///< added to the sample's pyramid level before the floor
  float* grey = nullptr;  ///< BearingSegment::kColumns accumulators per row
};

/// Adds the samples of a tile to `grey`. Dispatches at run time to the widest vector instructions
/// of the processor.
void add_tile(const PatchTile& tile);

}  // namespace stillkite
