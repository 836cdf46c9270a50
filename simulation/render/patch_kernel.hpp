#pragma once

#include <array>
#include <cstdint>

#include "simulation/render/bearing_table.hpp"
#include "simulation/scene/ground_texture.hpp"

namespace stillkite {

/// One pyramid level of a patch's image, at coordinates (u, v) of the finest one.
struct PatchLevel {
  float scale = 1;  ///< of the level's coordinates, and what is added to them
  float shift = 0;
  float last_u = 0;  ///< of the level's last texel
  float last_v = 0;
  std::uint32_t pitch = 0;   ///< bytes from a row to the next
  std::uint32_t offset = 0;  ///< of the first texel from the image's, in bytes
};

/// A patch as one camera sees it; every array times the bearing b = (x, y, 1). The point seen along
/// b is at depth 1 / (inverse_depth . b) and texel (u . b, v . b) / (inverse_depth . b).
struct PatchView {
  std::array<float, 3> inverse_depth{};  ///< > 0 in front of the camera
  std::array<float, 3> u{};
  std::array<float, 3> v{};
  float width_texels = 0;  ///< of the rectangle, which may be more than the image's
  float height_texels = 0;
  float texels_per_cubed_depth = 0;     ///< a pixel covers depth^3 times this, in square texels
  bool mirrored = false;                ///< the rectangle is larger than the image
  const std::uint8_t* pairs = nullptr;  ///< of GroundTexture
  int level_count = 1;
  std::array<PatchLevel, 12> levels{};
};

/// A patch of which something may be seen, and between which inverse depths.
struct PatchCandidate {
  const PatchView* view = nullptr;
  float least_inverse_depth = 0;  ///< <= 0: as far as can be
  float most_inverse_depth = 0;
};

/// One sample a pixel of a rectangle of pixels, and the patches that may be seen there.
struct PatchTile {
  static constexpr int kRows = 16;  ///< at most

  const PatchCandidate* candidates = nullptr;
  int candidate_count = 0;
  bool covered = false;  ///< by its only candidate
  float background_grey = 0;
  int rows = 0;
  const BearingSegment* const* segments = nullptr;  ///< a row
  float offset = 0;                                 ///< of the sample from its pixel, along the row
  float round_up = 0;     ///< added to the sample's pyramid level before the floor
  float* grey = nullptr;  ///< of BearingSegment::kColumns pixels a row; the values are added
};

/// With the widest vector instructions of this processor, chosen at run time.
void add_tile(const PatchTile& tile);

}  // namespace stillkite
