#include <algorithm>
#include <array>
#include <cmath>

#include "flow/tile_sums.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "flow/tile_shift.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// highway.h first
#include <hwy/cache_control.h>

HWY_BEFORE_NAMESPACE();
namespace stillkite {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// A tile's rows go through 16-bit lanes: pixels in 1/64 grey, residuals in 1/16 grey, gradients as
// differences over two pixels; products are added up in 32-bit lanes, a pair of columns each.
// The sum of a and b's products of neighbours, added to `sum`.
template <class V16, class V32>
HWY_INLINE V32 add_products(V16 a, V16 b, V32 sum) {
  const hn::DFromV<V32> d;
  V32 odd = hn::Zero(d);
  sum = hn::ReorderWidenMulAccumulate(d, a, b, sum, odd);
  return hn::Add(sum, odd);
}

// A sum per pair of columns with its moments about the middle of the tile. The moment along a row
// takes a pair as one column, the one down the rows comes from the running sum of the sum.
template <class V32>
struct Moments {
  V32 sum;
  V32 running;

  HWY_INLINE void add(V32 increased) {
    sum = increased;
    running = hn::Add(running, increased);
  }
};
struct MomentTotals {
  float sum, by_x, by_y;
};
template <class V32, class VF>
HWY_INLINE MomentTotals total(const Moments<V32>& m, VF column, int rows) {
  const hn::DFromV<VF> d;
  const VF sum = hn::ConvertTo(d, m.sum);
  const float all = hn::GetLane(hn::SumOfLanes(d, sum));
  const float running = hn::GetLane(hn::SumOfLanes(d, hn::ConvertTo(d, m.running)));
  // row k entered the running sum rows - k times
  return {all, hn::GetLane(hn::SumOfLanes(d, hn::Mul(sum, column))),
          (static_cast<float>(rows) - 0.5F * static_cast<float>(rows - 1)) * all - running};
}
template <class V32>
HWY_INLINE float total(V32 sum) {
  const hn::Rebind<float, hn::DFromV<V32>> d;
  return hn::GetLane(hn::SumOfLanes(d, hn::ConvertTo(d, sum)));
}
HWY_INLINE MomentTotals operator+(const MomentTotals& a, const MomentTotals& b) {
  return {a.sum + b.sum, a.by_x + b.by_x, a.by_y + b.by_y};
}

struct TilePlace {
  const std::uint8_t* reference;
  const std::uint8_t* current;
  int fraction_x, fraction_y;  // of a pixel, in 1/128
};

template <int kColumns, bool kFine, bool kWithContrast>
TileSums shifted_tile(const TilePlace& at, std::ptrdiff_t ref_stride, std::ptrdiff_t cur_stride,
                      int rows, const Deformation& a, int gain_q15) {
  using D16 = hn::CappedTag<std::int16_t, kColumns>;
  using D32 = hn::RepartitionToWide<D16>;
  using DF = hn::Rebind<float, D32>;
  using V16 = hn::Vec<D16>;
  using V32 = hn::Vec<D32>;
  using VF = hn::Vec<DF>;
  const D16 d;
  const hn::Rebind<std::uint8_t, D16> d8;
  const auto load = [&](const std::uint8_t* p) { return hn::PromoteTo(d, hn::LoadU(d8, p)); };
  const CubicWeights& wx = cubic_weights(at.fraction_x);
  const CubicWeights& wy = cubic_weights(at.fraction_y);
  const V16 x0 = hn::Set(d, wx.q6[0]), x1 = hn::Set(d, wx.q6[1]), x2 = hn::Set(d, wx.q6[2]),
            x3 = hn::Set(d, wx.q6[3]);
  const V16 y0 = hn::Set(d, wy.q15[0]), y1 = hn::Set(d, wy.q15[1]), y2 = hn::Set(d, wy.q15[2]),
            y3 = hn::Set(d, wy.q15[3]);
  const V16 linear_x = hn::Set(d, static_cast<std::int16_t>(at.fraction_x / 2));   // in 1/64
  const V16 linear_y = hn::Set(d, static_cast<std::int16_t>(at.fraction_y << 8));  // in 1/32768
  const V16 gain = hn::Set(d, static_cast<std::int16_t>(gain_q15));
  const V16 one = hn::Set(d, 1);
  const auto across = [&](const std::uint8_t* p) {
    if constexpr (kFine) {
      return hn::Add(hn::Add(hn::Mul(load(p - 1), x0), hn::Mul(load(p), x1)),
                     hn::Add(hn::Mul(load(p + 1), x2), hn::Mul(load(p + 2), x3)));
    } else {
      const V16 left = load(p);
      return hn::Add(hn::ShiftLeft<6>(left), hn::Mul(hn::Sub(load(p + 1), left), linear_x));
    }
  };

  TileSums s{};
  MomentTotals xx{}, xy{}, yy{}, mx{}, my{};
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int first = 0; first < kColumns; first += lanes) {
    const V32 zero = hn::Zero(D32());
    Moments<V32> gxx{zero, zero}, gxy{zero, zero}, gyy{zero, zero};
    V32 gx = zero, gy = zero, sr = zero, rr = zero, s0 = zero, s00 = zero, s0r = zero;
    V16 sum_x = hn::Zero(d), sum_y = sum_x, running_x = sum_x, running_y = sum_x;

    const std::uint8_t* p = at.reference + first;
    const std::uint8_t* q = at.current + first;
    V16 up = load(p - ref_stride);
    V16 middle = load(p);
    V16 above2 = across(q - cur_stride);
    V16 above = across(q);
    V16 below = across(q + cur_stride);
    q += 2 * cur_stride;
    for (int row = 0; row < rows; ++row) {
      const V16 down = load(p + ref_stride);
      const V16 ix = hn::Sub(load(p + 1), load(p - 1));
      const V16 iy = hn::Sub(down, up);
      const V16 below2 = across(q);
      V16 warped;
      if constexpr (kFine) {
        warped = hn::Add(hn::Add(hn::MulFixedPoint15(above2, y0), hn::MulFixedPoint15(above, y1)),
                         hn::Add(hn::MulFixedPoint15(below, y2), hn::MulFixedPoint15(below2, y3)));
      } else {
        warped = hn::Add(above, hn::MulFixedPoint15(hn::Sub(below, above), linear_y));
      }
      V16 expected = hn::ShiftLeft<6>(middle);
      expected = hn::SaturatedAdd(expected, hn::MulFixedPoint15(expected, gain));
      const V16 r = hn::ShiftRight<2>(hn::Sub(expected, warped));
      gxx.add(add_products(ix, ix, gxx.sum));
      gxy.add(add_products(ix, iy, gxy.sum));
      gyy.add(add_products(iy, iy, gyy.sum));
      gx = add_products(ix, r, gx);
      gy = add_products(iy, r, gy);
      sr = add_products(r, one, sr);
      sum_x = hn::Add(sum_x, ix);
      sum_y = hn::Add(sum_y, iy);
      running_x = hn::Add(running_x, sum_x);
      running_y = hn::Add(running_y, sum_y);
      if constexpr (kWithContrast) {
        rr = add_products(r, r, rr);
        s0 = add_products(middle, one, s0);
        s00 = add_products(middle, middle, s00);
        s0r = add_products(middle, r, s0r);
      }
      up = middle;
      middle = down;
      above2 = above;
      above = below;
      below = below2;
      p += ref_stride;
      q += cur_stride;
    }
    // a lane holds the pair of columns (2 k, 2 k + 1)
    const VF column = hn::MulAdd(
        hn::Iota(DF(), 0.0F), hn::Set(DF(), 2.0F),
        hn::Set(DF(), static_cast<float>(first) - 0.5F * static_cast<float>(kColumns) + 1));
    xx = xx + total(gxx, column, rows);
    xy = xy + total(gxy, column, rows);
    yy = yy + total(gyy, column, rows);
    mx =
        mx + total(Moments<V32>{add_products(sum_x, one, zero), add_products(running_x, one, zero)},
                   column, rows);
    my =
        my + total(Moments<V32>{add_products(sum_y, one, zero), add_products(running_y, one, zero)},
                   column, rows);
    s.gx += total(gx) / 32;
    s.gy += total(gy) / 32;
    s.r += total(sr) / 16;
    if constexpr (kWithContrast) {
      s.rr += total(rr) / 256;
      s.i0 += total(s0);
      s.i0i0 += total(s00);
      s.i0r += total(s0r) / 16;
    }
  }
  s.gxx = xx.sum / 4;
  s.gxy = xy.sum / 4;
  s.gyy = yy.sum / 4;
  s.ix = mx.sum / 2;
  s.iy = my.sum / 2;
  // the tile was shifted, not deformed: to first order r <- r - grad . (A - 1) (x - centre)
  const float bxx = a.xx - 1, bxy = a.xy, byx = a.yx, byy = a.yy - 1;
  s.gx -= (bxx * xx.by_x + bxy * xx.by_y + byx * xy.by_x + byy * xy.by_y) / 4;
  s.gy -= (bxx * xy.by_x + bxy * xy.by_y + byx * yy.by_x + byy * yy.by_y) / 4;
  s.r -= (bxx * mx.by_x + bxy * mx.by_y + byx * my.by_x + byy * my.by_y) / 2;
  return s;
}

// Where a tile lands in the current image, in whole pixels and 1/128.
struct Landing {
  float dx, dy;  // as asked for
  int steps_x, steps_y;
  int x, y;

  [[nodiscard]] bool is_inside(const TileGrid& grid, const ImageView& cur) const {
    return x >= 1 && y >= 1 && x + grid.columns + 1 < cur.width && y + grid.rows + 1 < cur.height;
  }
};
HWY_INLINE Landing land(const TileGrid& grid, const TilePlacement& placement, int i) {
  const auto steps = [](float d) {
    return static_cast<int>(std::floor(std::clamp(d, -1e5F, 1e5F) * 128.0F + 0.5F));
  };
  Landing at{};
  at.dx = placement.x_px[i] - grid.centre_x_px[i];
  at.dy = placement.y_px[i] - grid.centre_y_px[i];
  at.steps_x = steps(at.dx);
  at.steps_y = steps(at.dy);
  at.x = grid.left_px[i] + (at.steps_x >> 7);
  at.y = grid.top_px[i] + (at.steps_y >> 7);
  return at;
}

// A tile is some twenty short rows of two images, more streams than a processor fetches ahead by
// itself.
HWY_INLINE void fetch_ahead(const ImageView& ref, const ImageView& cur, const TileGrid& grid,
                            const TilePlacement& placement, int i) {
  const Landing at = land(grid, placement, i);
  if (!at.is_inside(grid, cur)) return;
  const std::uint8_t* p = ref.data + grid.top_px[i] * ref.stride + grid.left_px[i];
  const std::uint8_t* q = cur.data + at.y * cur.stride + at.x;
  for (int row = 0; row < grid.rows; ++row) {
    hwy::Prefetch(p + row * ref.stride);
    hwy::Prefetch(q + row * cur.stride);
  }
}

template <int kColumns, bool kFine, bool kWithContrast>
void measure_all(const ImageView& ref, const ImageView& cur, const TileGrid& grid,
                 const TilePlacement& placement, float gain, TileMeasurements& out) {
  constexpr int kAhead = 4;
  const int gain_q15 =
      static_cast<int>(std::lround(std::clamp(gain - 1.0F, -0.99F, 0.99F) * 32768.0F));
  const float pixels = static_cast<float>(grid.columns * grid.rows);
  for (int i = 0; i < grid.count; ++i) {
    if (i + kAhead < grid.count) fetch_ahead(ref, cur, grid, placement, i + kAhead);
    const Landing to = land(grid, placement, i);
    if (!to.is_inside(grid, cur)) {
      store({}, pixels, {}, i, out);
      continue;
    }
    const TilePlace at{ref.data + grid.top_px[i] * ref.stride + grid.left_px[i],
                       cur.data + to.y * cur.stride + to.x, to.steps_x & 127, to.steps_y & 127};
    const Deformation a{placement.axx[i], placement.axy[i], placement.ayx[i], placement.ayy[i]};
    store(shifted_tile<kColumns, kFine, kWithContrast>(at, ref.stride, cur.stride, grid.rows, a,
                                                       gain_q15),
          pixels, a, i, out);
    // the shift was rounded to 1/128 px: refer the step to the place that was asked for
    const float ex = static_cast<float>(to.steps_x) / 128.0F - to.dx;
    const float ey = static_cast<float>(to.steps_y) / 128.0F - to.dy;
    out.gx[i] += out.gxx[i] * ex + out.gxy[i] * ey;
    out.gy[i] += out.gxy[i] * ex + out.gyy[i] * ey;
  }
}

void measure_shifted_kernel(const ImageView& ref, const ImageView& cur, const TileGrid& grid,
                            const TilePlacement& placement, float gain, const TileEffort& effort,
                            TileMeasurements& out) {
  const auto measure = [&](auto measure_of) { measure_of(ref, cur, grid, placement, gain, out); };
  const bool wide = grid.columns == 32;
  if (effort.cubic) {
    const auto with = wide ? measure_all<32, true, true> : measure_all<16, true, true>;
    const auto without = wide ? measure_all<32, true, false> : measure_all<16, true, false>;
    measure(effort.contrast ? with : without);
  } else {
    const auto with = wide ? measure_all<32, false, true> : measure_all<16, false, true>;
    const auto without = wide ? measure_all<32, false, false> : measure_all<16, false, false>;
    measure(effort.contrast ? with : without);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace stillkite
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stillkite {

HWY_EXPORT(measure_shifted_kernel);

void measure_shifted(const ImageView& reference, const ImageView& current, const TileGrid& grid,
                     const TilePlacement& placement, float gain, const TileEffort& effort,
                     TileMeasurements& out) {
  HWY_DYNAMIC_DISPATCH(measure_shifted_kernel)
  (reference, current, grid, placement, gain, effort, out);
}

}  // namespace stillkite
#endif
