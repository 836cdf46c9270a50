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

template <class V>
struct Cubic {
  V before, left, right, after;
};

TileSums deformed_tile(const ImageView& ref, const ImageView& cur, int left, int top, int columns,
                       int rows, float x, float y, float axx, float axy, float ayx, float ayy,
                       float gain) {
  const hn::CappedTag<float, 16> d;
  const hn::Rebind<std::int32_t, decltype(d)> di;
  const hn::Rebind<std::uint8_t, decltype(d)> d8;
  using V = hn::Vec<decltype(d)>;
  using VI = hn::Vec<decltype(di)>;
  const auto load = [&](const std::uint8_t* p) {
    return hn::ConvertTo(d, hn::PromoteTo(di, hn::LoadU(d8, p)));
  };
  const VI byte = hn::Set(di, 0xFF);
  const VI stride = hn::Set(di, static_cast<std::int32_t>(cur.stride));
  const V half = hn::Set(d, 0.5F);
  const V one = hn::Set(d, 1.0F);
  const V three = hn::Set(d, 3.0F);
  const auto* base = reinterpret_cast<const std::int32_t*>(cur.data);
  // Keys' cubic weights (a = -1/2) of the four pixels about a fraction: bilinear weights would
  // shift fine texture by up to 1/50 px
  const auto weights = [&](V f) {
    const V f2 = hn::Mul(f, f);
    const V outer = hn::MulSub(half, f2, hn::Mul(half, f));  // f (f - 1) / 2
    const V before = hn::NegMulAdd(f, outer, outer);         // outer (1 - f)
    const V after = hn::Mul(f, outer);
    const V right = hn::NegMulAdd(three, after, hn::Add(f, outer));
    return Cubic<V>{before, hn::Sub(hn::Sub(hn::Sub(one, before), right), after), right, after};
  };
  // one gather brings the four pixels of a row
  const auto across = [&](VI offset, const Cubic<V>& w) {
    const VI four = hn::GatherOffset(di, base, offset);
    const V p0 = hn::ConvertTo(d, hn::And(four, byte));
    const V p1 = hn::ConvertTo(d, hn::And(hn::ShiftRight<8>(four), byte));
    const V p2 = hn::ConvertTo(d, hn::And(hn::ShiftRight<16>(four), byte));
    const V p3 = hn::ConvertTo(d, hn::And(hn::ShiftRight<24>(four), byte));
    return hn::MulAdd(w.before, p0,
                      hn::MulAdd(w.left, p1, hn::MulAdd(w.right, p2, hn::Mul(w.after, p3))));
  };

  V gx = hn::Zero(d), gy = gx, sr = gx, rr = gx, s0 = gx, s00 = gx, s0r = gx;
  const V vgain = hn::Set(d, gain);
  for (int column = 0; column < columns; column += static_cast<int>(hn::Lanes(d))) {
    const V from_centre =
        hn::Add(hn::Iota(d, 0.0F),
                hn::Set(d, static_cast<float>(column) - 0.5F * static_cast<float>(columns - 1)));
    const std::uint8_t* p = ref.data + top * ref.stride + left + column;
    const float first_row = -0.5F * static_cast<float>(rows - 1);
    V u = hn::MulAdd(from_centre, hn::Set(d, axx), hn::Set(d, x + axy * first_row));
    V v = hn::MulAdd(from_centre, hn::Set(d, ayx), hn::Set(d, y + ayy * first_row));
    V up = load(p - ref.stride);
    V middle = load(p);
    for (int row = 0; row < rows; ++row) {
      const V down = load(p + ref.stride);
      const V ix = hn::Mul(half, hn::Sub(load(p + 1), load(p - 1)));
      const V iy = hn::Mul(half, hn::Sub(down, up));
      // inside the image u and v are positive: truncation is floor
      const VI iu = hn::ConvertTo(di, u);
      const VI iv = hn::ConvertTo(di, v);
      const V fu = hn::Sub(u, hn::ConvertTo(d, iu));
      const V fv = hn::Sub(v, hn::ConvertTo(d, iv));
      const Cubic<V> wu = weights(fu);
      const Cubic<V> wv = weights(fv);
      VI offset =
          hn::Add(hn::Mul(hn::Sub(iv, hn::Set(di, 1)), stride), hn::Sub(iu, hn::Set(di, 1)));
      V warped = hn::Mul(wv.before, across(offset, wu));
      offset = hn::Add(offset, stride);
      warped = hn::MulAdd(wv.left, across(offset, wu), warped);
      offset = hn::Add(offset, stride);
      warped = hn::MulAdd(wv.right, across(offset, wu), warped);
      offset = hn::Add(offset, stride);
      warped = hn::MulAdd(wv.after, across(offset, wu), warped);
      const V r = hn::MulSub(middle, vgain, warped);
      gx = hn::MulAdd(ix, r, gx);
      gy = hn::MulAdd(iy, r, gy);
      rr = hn::MulAdd(r, r, rr);
      sr = hn::Add(sr, r);
      s0 = hn::Add(s0, middle);
      s00 = hn::MulAdd(middle, middle, s00);
      s0r = hn::MulAdd(middle, r, s0r);
      u = hn::Add(u, hn::Set(d, axy));
      v = hn::Add(v, hn::Set(d, ayy));
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
  // the cubic reaches one pixel back and two on
  const float last_x = static_cast<float>(cur.width - 4);
  const float last_y = static_cast<float>(cur.height - 4);
  for (int i = 0; i < grid.count; ++i) {
    const float x = at.x_px[i];
    const float y = at.y_px[i];
    const float axx = at.axx[i], axy = at.axy[i], ayx = at.ayx[i], ayy = at.ayy[i];
    const float reach_x = std::abs(axx) * half_width + std::abs(axy) * half_height;
    const float reach_y = std::abs(ayx) * half_width + std::abs(ayy) * half_height;
    const bool inside = x - reach_x >= 2 && y - reach_y >= 2 && x + reach_x <= last_x &&
                        y + reach_y <= last_y && axx * ayy - axy * ayx > 0.1F;
    if (!inside) {
      store({}, {}, pixels, {}, i, out);
      continue;
    }
    const TileTexture& texture = grid.columns == 32 ? texture_at<32>(ref, grid, i, textures)
                                                    : texture_at<16>(ref, grid, i, textures);
    store(texture,
          deformed_tile(ref, cur, grid.left_px[i], grid.top_px[i], grid.columns, grid.rows, x, y,
                        axx, axy, ayx, ayy, gain),
          pixels, {axx, axy, ayx, ayy}, i, out);
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
