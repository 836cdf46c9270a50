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
struct SixWeights {
  V a, b, c, d, e, f;
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
  const auto* base = reinterpret_cast<const std::int32_t*>(cur.data);
  // as quintic_weights(), of the products of the distances to the six pixels
  const auto weights = [&](V f) {
    const auto from = [&](float k) { return hn::Sub(f, hn::Set(d, k)); };
    const V before = hn::Mul(hn::Mul(from(-2), from(-1)), f);
    const V after = hn::Mul(hn::Mul(from(1), from(2)), from(3));
    const auto weight = [&](V product, float unit) { return hn::Mul(product, hn::Set(d, unit)); };
    return SixWeights<V>{weight(hn::Mul(hn::Mul(from(-1), f), after), -1.0F / 120),
                         weight(hn::Mul(hn::Mul(from(-2), f), after), 1.0F / 24),
                         weight(hn::Mul(hn::Mul(from(-2), from(-1)), after), -1.0F / 12),
                         weight(hn::Mul(hn::Mul(from(2), from(3)), before), 1.0F / 12),
                         weight(hn::Mul(hn::Mul(from(1), from(3)), before), -1.0F / 24),
                         weight(hn::Mul(hn::Mul(from(1), from(2)), before), 1.0F / 120)};
  };
  // two gathers bring the six pixels of a row, the first from two pixels back; both stay inside it
  const auto across = [&](VI offset, const SixWeights<V>& w) {
    const VI first = hn::GatherOffset(di, base, offset);
    const VI last = hn::GatherOffset(di, base, hn::Add(offset, hn::Set(di, 2)));
    const auto pixel = [&](VI v) { return hn::ConvertTo(d, hn::And(v, byte)); };
    V sum = hn::Mul(w.a, pixel(first));
    sum = hn::MulAdd(w.b, pixel(hn::ShiftRight<8>(first)), sum);
    sum = hn::MulAdd(w.c, pixel(hn::ShiftRight<16>(first)), sum);
    sum = hn::MulAdd(w.d, pixel(hn::ShiftRight<24>(first)), sum);
    sum = hn::MulAdd(w.e, pixel(hn::ShiftRight<16>(last)), sum);
    return hn::MulAdd(w.f, pixel(hn::ShiftRight<24>(last)), sum);
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
      const SixWeights<V> wu = weights(fu);
      const SixWeights<V> wv = weights(fv);
      VI offset = hn::Add(hn::Mul(iv, stride), iu);
      offset = hn::Sub(offset, hn::Set(di, 2 + 2 * static_cast<std::int32_t>(cur.stride)));
      V warped = hn::Mul(wv.a, across(offset, wu));
      for (const V& weight : {wv.b, wv.c, wv.d, wv.e, wv.f}) {
        offset = hn::Add(offset, stride);
        warped = hn::MulAdd(weight, across(offset, wu), warped);
      }
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
  constexpr float kFirst = TileGrid::kBefore_px;
  const float last_x = static_cast<float>(cur.width - 1 - TileGrid::kAfter_px);
  const float last_y = static_cast<float>(cur.height - 1 - TileGrid::kAfter_px);
  for (int i = 0; i < grid.count; ++i) {
    const float x = at.x_px[i];
    const float y = at.y_px[i];
    const float axx = at.axx[i], axy = at.axy[i], ayx = at.ayx[i], ayy = at.ayy[i];
    const float reach_x = std::abs(axx) * half_width + std::abs(axy) * half_height;
    const float reach_y = std::abs(ayx) * half_width + std::abs(ayy) * half_height;
    const bool inside = x - reach_x >= kFirst && y - reach_y >= kFirst && x + reach_x <= last_x &&
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
