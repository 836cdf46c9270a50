#pragma once

#include <array>
#include <cstdint>

namespace stillkite {

/// a0 + s (a . b): affine function of the point at camera depth s along the bearing b = (x, y, 1).
struct RayFunction {
  float at_camera = 0;
  std::array<float, 3> per_bearing{};
};

/// Constants of the inner loop for one pose over one ground. Ground coordinates are in texels
/// relative to an integer texel near the camera: single precision suffices at any position.
struct RenderView {
  static constexpr int kMaxLevels = 24;

  // Depth on z = 0: s = height / (down . b), valid where down . b > 0.
  std::array<float, 3> down_per_bearing{};
  float height_m = 0;  ///< height of the camera over z = 0
  float sky_grey = 0;

  RayFunction u;
  RayFunction v;
  float base_u = 0;  ///< integer texel coordinates of the relative origin
  float base_v = 0;
  const std::uint8_t* pairs = nullptr;  ///< GroundTexture::pairs
  int levels = 1;
  float texels_per_square_depth = 0;  ///< footprint of a sample / s^2, in texels
  alignas(64) std::array<float, kMaxLevels> level_scale{};  ///< 2^-level
  alignas(64) std::array<std::int32_t, kMaxLevels> level_offset{};
  alignas(64) std::array<std::int32_t, kMaxLevels> level_width{};
  alignas(64) std::array<std::int32_t, kMaxLevels> level_height{};
  alignas(64) std::array<std::int32_t, kMaxLevels> level_pitch{};

  const std::uint32_t* relief_words = nullptr;  ///< Relief::words; null: flat ground
  RayFunction relief_x;                         ///< in cells of the relief
  RayFunction relief_y;
  float relief_metres_per_count = 0;
  int relief_steps = 2;  ///< fixed-point iterations

  const std::uint8_t* vehicle_pairs = nullptr;  ///< GroundTexture::pairs; null: no vehicle
  RayFunction vehicle_along;                    ///< -1 at the rear, 1 at the front
  RayFunction vehicle_across;                   ///< -1 and 1 at the sides
  int vehicle_pitch = 0;
  int vehicle_width = 0;  ///< texture size in texels
  int vehicle_height = 0;

  RayFunction shadow_along;  ///< along the sun's azimuth, in outer radii from the centre
  RayFunction shadow_across;
  float shadow_along_per_height = 0;  ///< displacement per metre of ground height
  float shadow_ramp = 0;              ///< darkening: ramp x (1 - radius), within 0 to 1
  float shadow_darkening_ratio = 0;   ///< 0: no shadow
};

/// Adjacent pixels of one row: `samples` bearings per pixel, each a row of `count` values.
struct RenderRow {
  int count = 0;  ///< multiple of kRowPadding
  int samples = 0;
  const float* const* bearing_x = nullptr;
  const float* const* bearing_y = nullptr;
  bool uniform_y = false;                   ///< bearing_y has one value per sample for all pixels
  float* const* ground_height_m = nullptr;  ///< in: initial z per sample; out: solution (relief)
  float* grey = nullptr;                    ///< out: mean over the samples
};
inline constexpr int kRowPadding = 16;

/// Dispatches at run time to the widest vector instructions of the processor.
void render_row(const RenderView& view, const RenderRow& row);

}  // namespace stillkite
