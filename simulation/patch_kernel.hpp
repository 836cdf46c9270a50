#pragma once

#include <array>
#include <cstdint>

#include "simulation/bearing_table.hpp"
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
  float texels_per_cubed_depth = 0;     ///< a pixel covers depth^3 times this, in square texels
  bool mirrored = false;                ///< the rectangle is larger than the picture
  const std::uint8_t* pairs = nullptr;  ///< of GroundTexture
  const GroundTexture::Level* levels = nullptr;
  int level_count = 1;
};

/// One sample a pixel of a rectangle of pixels, and the patches that may be seen there.
struct PatchTile {
  static constexpr int kRows = 16;  ///< at most

  const PatchView* const* candidates = nullptr;
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
