#pragma once

#include <array>
#include <cstdint>

namespace stillkite {

/// a0 + s (a . b): an affine function of the ground point that the bearing b = (x, y, 1) hits at
/// distance s along it, b scaled to the camera's depth.
struct RayFunction {
  float at_camera = 0;
  std::array<float, 3> per_bearing{};
};

/// What the inner loop needs of one pose over one ground. Ground coordinates are in texels relative
/// to a whole texel near the camera, so that single precision suffices wherever the camera is.
struct RenderView {
  static constexpr int kMaxLevels = 24;

  // The way down: depth s = height / (down . b), valid where down . b > 0.
  std::array<float, 3> down_per_bearing{};
  float height_m = 0;  ///< of the camera over z = 0
  float sky_grey = 0;

  RayFunction u;
  RayFunction v;
  float base_u = 0;  ///< whole texels from the texture's first one to the relative origin
  float base_v = 0;
  const std::uint8_t* pairs = nullptr;  ///< of GroundTexture
  int levels = 1;
  float texels_per_square_depth = 0;  ///< footprint of a sample in texels is s^2 times this
  alignas(64) std::array<float, kMaxLevels> level_scale{};  ///< 2^-level
  alignas(64) std::array<std::int32_t, kMaxLevels> level_offset{};
  alignas(64) std::array<std::int32_t, kMaxLevels> level_width{};
  alignas(64) std::array<std::int32_t, kMaxLevels> level_height{};
  alignas(64) std::array<std::int32_t, kMaxLevels> level_pitch{};

  const std::uint32_t* relief_words = nullptr;  ///< of Relief; null: a flat ground
  RayFunction relief_x;                         ///< in cells of the relief
  RayFunction relief_y;
  float relief_metres_per_count = 0;
  int relief_steps = 2;  ///< of the fixed point, from the row above

  const std::uint8_t* vehicle_pairs = nullptr;  ///< of its texture; null: none
  RayFunction vehicle_along;                    ///< -1 at the rear, 1 at the front
  RayFunction vehicle_across;                   ///< -1 and 1 at the sides
  int vehicle_pitch = 0;
  int vehicle_width = 0;  ///< of its texture
  int vehicle_height = 0;
};

/// Neighbours in one row of pixels: `samples` bearings a pixel, each a row of `count` values.
struct RenderRow {
  int count = 0;  ///< a multiple of kRowPadding
  int samples = 0;
  const float* const* bearing_x = nullptr;
  const float* const* bearing_y = nullptr;
  bool even_y = false;  ///< each row of bearing_y is one value, the same for all pixels
  float* const* ground_height_m = nullptr;  ///< in: a first guess a sample; out: z found (relief)
  float* grey = nullptr;                    ///< out: mean over the samples
};
inline constexpr int kRowPadding = 16;

/// With the widest vector instructions of this processor, chosen at run time.
void render_row(const RenderView& view, const RenderRow& row);

}  // namespace stillkite
