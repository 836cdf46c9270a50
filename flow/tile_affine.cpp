#include <algorithm>
#include <cmath>

#include "flow/tile_sums.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "flow/tile_affine.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// highway.h first
#include "flow/tile_texture-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace stillkite {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, 16>;
using DI = hn::Rebind<std::int32_t, D>;
using V = hn::Vec<D>;
using VI = hn::Vec<DI>;

constexpr int kMaxLanes = 16;

// Affine map of a tile to the current image: centre and deformation about it.
struct TileMap {
  float x = 0, y = 0;
  Deformation a;
};

// Warped pixels of one SIMD vector of columns.
struct WarpedColumns {
  HWY_ALIGN float rows[TileGrid::kMaxRows][kMaxLanes];
};

struct SixWeights {
  V a, b, c, d, e, f;
};

// Weights of quintic_weights(), evaluated from the products of the distances to the six pixels.
HWY_INLINE SixWeights six_weights(V fraction) {
  const D d;
  const auto from = [&](float k) { return hn::Sub(fraction, hn::Set(d, k)); };
  const V before = hn::Mul(hn::Mul(from(-2), from(-1)), fraction);
  const V after = hn::Mul(hn::Mul(from(1), from(2)), from(3));
  const auto weight = [&](V product, float unit) { return hn::Mul(product, hn::Set(d, unit)); };
  return {weight(hn::Mul(hn::Mul(from(-1), fraction), after), -1.0F / 120),
          weight(hn::Mul(hn::Mul(from(-2), fraction), after), 1.0F / 24),
          weight(hn::Mul(hn::Mul(from(-2), from(-1)), after), -1.0F / 12),
          weight(hn::Mul(hn::Mul(from(2), from(3)), before), 1.0F / 12),
          weight(hn::Mul(hn::Mul(from(1), from(3)), before), -1.0F / 24),
          weight(hn::Mul(hn::Mul(from(1), from(2)), before), 1.0F / 120)};
}

// Interpolation along a row. Two gathers load exactly the six pixels from `offset` on.
HWY_INLINE V interpolate_row(const std::uint8_t* image, VI offset, const SixWeights& w) {
  const D d;
  const DI di;
  const auto* base = reinterpret_cast<const std::int32_t*>(image);
  const VI first = hn::GatherOffset(di, base, offset);
  const VI last = hn::GatherOffset(di, base, hn::Add(offset, hn::Set(di, 2)));
  const VI byte = hn::Set(di, 0xFF);
  const auto pixel = [&](VI v) { return hn::ConvertTo(d, hn::And(v, byte)); };
  V sum = hn::Mul(w.a, pixel(first));
  sum = hn::MulAdd(w.b, pixel(hn::ShiftRight<8>(first)), sum);
  sum = hn::MulAdd(w.c, pixel(hn::ShiftRight<16>(first)), sum);
  sum = hn::MulAdd(w.d, pixel(hn::ShiftRight<24>(first)), sum);
  sum = hn::MulAdd(w.e, pixel(hn::ShiftRight<16>(last)), sum);
  return hn::MulAdd(w.f, pixel(hn::ShiftRight<24>(last)), sum);
}

// General deformation: interpolates six rows about each pixel.
void warp_columns(const ImageView& image, const TileMap& map, int rows, V from_centre,
                  WarpedColumns& out) {
  const D d;
  const DI di;
  const auto stride = static_cast<std::int32_t>(image.stride);
  const V u_middle = hn::MulAdd(from_centre, hn::Set(d, map.a.xx), hn::Set(d, map.x));
  const V v_middle = hn::MulAdd(from_centre, hn::Set(d, map.a.yx), hn::Set(d, map.y));
  for (int row = 0; row < rows; ++row) {
    const float down = static_cast<float>(row) - 0.5F * static_cast<float>(rows - 1);
    const V u = hn::Add(u_middle, hn::Set(d, map.a.xy * down));
    const V v = hn::Add(v_middle, hn::Set(d, map.a.yy * down));
    // u and v are positive inside the image: truncation is floor
    const VI iu = hn::ConvertTo(di, u);
    const VI iv = hn::ConvertTo(di, v);
    const SixWeights wu = six_weights(hn::Sub(u, hn::ConvertTo(d, iu)));
    const SixWeights wv = six_weights(hn::Sub(v, hn::ConvertTo(d, iv)));
    VI offset = hn::Add(hn::Mul(iv, hn::Set(di, stride)), iu);
    offset = hn::Sub(offset, hn::Set(di, 2 + 2 * stride));
    V warped = hn::Mul(wv.a, interpolate_row(image.data, offset, wu));
    for (const V& weight : {wv.b, wv.c, wv.d, wv.e, wv.f}) {
      offset = hn::Add(offset, hn::Set(di, stride));
      warped = hn::MulAdd(weight, interpolate_row(image.data, offset, wu), warped);
    }
    hn::Store(warped, d, out.rows[row]);
  }
}

// Limits of the separable warp: the columns of one row span at most two image rows, and the shear
// of a column exceeds the tile by less than a pixel.
bool is_small(const Deformation& a) {
  return std::abs(a.yx) * (kMaxLanes - 1) <= 1 && std::abs(a.xy) <= 0.2F * a.yy && a.yy <= 1.25F;
}

// Separable warp for small deformations, with a quarter of the gathers: interpolates each image row
// at its intersections with the tile's columns, then along the columns.
void warp_columns_separable(const ImageView& image, const TileMap& map, int rows, V from_centre,
                            WarpedColumns& out) {
  constexpr int kMaxRowSamples = TileGrid::kMaxRows * 5 / 4 + 8;
  const D d;
  const DI di;
  const float half = 0.5F * static_cast<float>(rows - 1);
  const V v_middle = hn::MulAdd(from_centre, hn::Set(d, map.a.yx), hn::Set(d, map.y));
  const float min_v = hn::GetLane(hn::MinOfLanes(d, v_middle));
  const auto row_above = [&](int row) {
    return static_cast<int>(min_v + map.a.yy * (static_cast<float>(row) - half));
  };
  const int first = row_above(0) - TileGrid::kBefore_px;
  const int last = row_above(rows - 1) + 1 + TileGrid::kAfter_px;

  HWY_ALIGN float row_samples[kMaxRowSamples][kMaxLanes];
  const float shear = map.a.xy / map.a.yy;
  const V u_middle =
      hn::MulAdd(from_centre, hn::Set(d, map.a.xx - shear * map.a.yx), hn::Set(d, map.x));
  for (int row = first; row <= last; ++row) {
    const V u = hn::Add(u_middle, hn::Set(d, shear * (static_cast<float>(row) - map.y)));
    const VI iu = hn::ConvertTo(di, u);
    // a row beyond the image has weight 0
    const int clamped_row = std::clamp(row, 0, image.height - 1);
    const V grey = interpolate_row(image.data + clamped_row * image.stride,
                                   hn::Sub(iu, hn::Set(di, TileGrid::kBefore_px)),
                                   six_weights(hn::Sub(u, hn::ConvertTo(d, iu))));
    hn::Store(grey, d, row_samples[row - first]);
  }
  for (int row = 0; row < rows; ++row) {
    const float down = map.a.yy * (static_cast<float>(row) - half);
    const int above = row_above(row);
    const V below =
        hn::Sub(hn::Add(v_middle, hn::Set(d, down)), hn::Set(d, static_cast<float>(above)));
    const V one = hn::Set(d, 1.0F);
    const auto is_next = hn::Ge(below, one);
    const SixWeights w = six_weights(hn::Sub(below, hn::IfThenElseZero(is_next, one)));
    const float(*from)[kMaxLanes] = row_samples + (above - TileGrid::kBefore_px - first);
    V warped = hn::Mul(hn::IfThenZeroElse(is_next, w.a), hn::Load(d, from[0]));
    warped = hn::MulAdd(hn::IfThenElse(is_next, w.a, w.b), hn::Load(d, from[1]), warped);
    warped = hn::MulAdd(hn::IfThenElse(is_next, w.b, w.c), hn::Load(d, from[2]), warped);
    warped = hn::MulAdd(hn::IfThenElse(is_next, w.c, w.d), hn::Load(d, from[3]), warped);
    warped = hn::MulAdd(hn::IfThenElse(is_next, w.d, w.e), hn::Load(d, from[4]), warped);
    warped = hn::MulAdd(hn::IfThenElse(is_next, w.e, w.f), hn::Load(d, from[5]), warped);
    warped = hn::MulAdd(hn::IfThenElseZero(is_next, w.f), hn::Load(d, from[6]), warped);
    hn::Store(warped, d, out.rows[row]);
  }
}

TileSums deformed_tile(const ImageView& ref, const ImageView& cur, int left, int top, int columns,
                       int rows, const TileMap& map, bool separable, float gain) {
  const D d;
  const DI di;
  const hn::Rebind<std::uint8_t, D> d8;
  const auto load = [&](const std::uint8_t* p) {
    return hn::ConvertTo(d, hn::PromoteTo(di, hn::LoadU(d8, p)));
  };
  const V half = hn::Set(d, 0.5F);
  const V vgain = hn::Set(d, gain);
  V gx = hn::Zero(d), gy = gx, sr = gx, rr = gx, s0 = gx, s00 = gx, s0r = gx;
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): written before it is read
  WarpedColumns warped;
  for (int column = 0; column < columns; column += static_cast<int>(hn::Lanes(d))) {
    const float first = static_cast<float>(column) - 0.5F * static_cast<float>(columns - 1);
    const V from_centre = hn::Iota(d, first);
    if (separable) {
      warp_columns_separable(cur, map, rows, from_centre, warped);
    } else {
      warp_columns(cur, map, rows, from_centre, warped);
    }
    const std::uint8_t* p = ref.data + top * ref.stride + left + column;
    V up = load(p - ref.stride);
    V middle = load(p);
    for (int row = 0; row < rows; ++row) {
      const V down = load(p + ref.stride);
      const V ix = hn::Mul(half, hn::Sub(load(p + 1), load(p - 1)));
      const V iy = hn::Mul(half, hn::Sub(down, up));
      const V r = hn::MulSub(middle, vgain, hn::Load(d, warped.rows[row]));
      gx = hn::MulAdd(ix, r, gx);
      gy = hn::MulAdd(iy, r, gy);
      rr = hn::MulAdd(r, r, rr);
      sr = hn::Add(sr, r);
      s0 = hn::Add(s0, middle);
      s00 = hn::MulAdd(middle, middle, s00);
      s0r = hn::MulAdd(middle, r, s0r);
      up = middle;
      middle = down;
      p += ref.stride;
    }
  }
  const auto total = [&](V w) { return hn::GetLane(hn::SumOfLanes(d, w)); };
  return {.gx = total(gx),
          .gy = total(gy),
          .r = total(sr),
          .rr = total(rr),
          .i0 = total(s0),
          .i0i0 = total(s00),
          .i0r = total(s0r)};
}

void measure_deformed_kernel(const ImageView& ref, const ImageView& cur, const TileGrid& grid,
                             const TilePlacement& at, float gain, TileTextures& textures,
                             TileMeasurements& out) {
  const float pixels = static_cast<float>(grid.columns * grid.rows);
  const float half_width = 0.5F * static_cast<float>(grid.columns - 1);
  const float half_height = 0.5F * static_cast<float>(grid.rows - 1);
  constexpr float kFirst = TileGrid::kBefore_px;
  const float last_x = static_cast<float>(cur.width - 1 - TileGrid::kAfter_px);
  const float last_y = static_cast<float>(cur.height - 1 - TileGrid::kAfter_px);
  for (int i = 0; i < grid.count; ++i) {
    const float x = at.x_px[i];
    const float y = at.y_px[i];
    const Deformation a{.xx = at.axx[i], .xy = at.axy[i], .yx = at.ayx[i], .yy = at.ayy[i]};
    const float reach_x = std::abs(a.xx) * half_width + std::abs(a.xy) * half_height;
    const float reach_y = std::abs(a.yx) * half_width + std::abs(a.yy) * half_height;
    const float margin_x = std::min(x - reach_x - kFirst, last_x - x - reach_x);
    const float margin_y = std::min(y - reach_y - kFirst, last_y - y - reach_y);
    if (!(margin_x >= 0 && margin_y >= 0 && a.xx * a.yy - a.xy * a.yx > 0.1F)) {
      store({}, {}, pixels, {}, i, out);
      continue;
    }
    const TileTexture& texture = grid.columns == 32 ? texture_at<32>(ref, grid, i, textures)
                                                    : texture_at<16>(ref, grid, i, textures);
    store(texture,
          deformed_tile(ref, cur, grid.left_px[i], grid.top_px[i], grid.columns, grid.rows,
                        {.x = x, .y = y, .a = a}, is_small(a) && margin_x >= 1, gain),
          pixels, a, i, out);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace stillkite
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stillkite {

HWY_EXPORT(measure_deformed_kernel);

void measure_deformed(const ImageView& reference, const ImageView& current, const TileGrid& grid,
                      const TilePlacement& placement, float gain, TileTextures& textures,
                      TileMeasurements& out) {
  HWY_DYNAMIC_DISPATCH(measure_deformed_kernel)
  (reference, current, grid, placement, gain, textures, out);
}

}  // namespace stillkite
#endif
