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

#include "flow/tile_texture-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace stillkite {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// 16-bit lanes: pixels in 1/64 grey, residuals in 1/16 grey, gradients as differences over two
// pixels. 32-bit lanes: sums of products, one per pair of columns.
struct TilePlace {
  const std::uint8_t* reference;
  const std::uint8_t* current;
  int fraction_x, fraction_y;  // in 1/128 px
};

template <class V>
struct SixTaps {
  V a, b, c, d, e, f;
};

// Weights in 1/32768.
template <class V>
HWY_INLINE V weighted(const SixTaps<V>& v, const SixTaps<V>& w) {
  const V outer = hn::Add(hn::MulFixedPoint15(v.a, w.a), hn::MulFixedPoint15(v.f, w.f));
  const V middle = hn::Add(hn::MulFixedPoint15(v.b, w.b), hn::MulFixedPoint15(v.e, w.e));
  const V inner = hn::Add(hn::MulFixedPoint15(v.c, w.c), hn::MulFixedPoint15(v.d, w.d));
  return hn::Add(hn::Add(outer, middle), inner);
}

template <int kColumns, bool kFine, bool kWithContrast>
TileSums shifted_tile(const TilePlace& at, std::ptrdiff_t ref_stride, std::ptrdiff_t cur_stride,
                      int rows, int gain_q15) {
  using D16 = hn::CappedTag<std::int16_t, kColumns>;
  using D32 = hn::RepartitionToWide<D16>;
  using V16 = hn::Vec<D16>;
  using V32 = hn::Vec<D32>;
  const D16 d;
  const hn::Rebind<std::uint8_t, D16> d8;
  const auto load = [&](const std::uint8_t* p) { return hn::PromoteTo(d, hn::LoadU(d8, p)); };
  const auto weights = [&](int fraction) {
    const QuinticWeights& w = quintic_weights(fraction);
    return SixTaps<V16>{hn::Set(d, w[0]), hn::Set(d, w[1]), hn::Set(d, w[2]),
                        hn::Set(d, w[3]), hn::Set(d, w[4]), hn::Set(d, w[5])};
  };
  const SixTaps<V16> taps_x = weights(at.fraction_x);
  const SixTaps<V16> taps_y = weights(at.fraction_y);
  const V16 linear_x = hn::Set(d, static_cast<std::int16_t>(at.fraction_x / 2));   // in 1/64
  const V16 linear_y = hn::Set(d, static_cast<std::int16_t>(at.fraction_y << 8));  // in 1/32768
  const V16 gain = hn::Set(d, static_cast<std::int16_t>(gain_q15));
  const V16 one = hn::Set(d, 1);
  const auto interpolate_row = [&](const std::uint8_t* p) {
    if constexpr (kFine) {
      const auto pixel = [&](int i) { return hn::ShiftLeft<6>(load(p + i)); };
      return weighted(SixTaps<V16>{pixel(-2), pixel(-1), pixel(0), pixel(1), pixel(2), pixel(3)},
                      taps_x);
    } else {
      const V16 left = load(p);
      return hn::Add(hn::ShiftLeft<6>(left), hn::Mul(hn::Sub(load(p + 1), left), linear_x));
    }
  };

  TileSums s{};
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int first = 0; first < kColumns; first += lanes) {
    const V32 zero = hn::Zero(D32());
    V32 gx = zero, gy = zero, sr = zero, rr = zero, s0 = zero, s00 = zero, s0r = zero;

    const std::uint8_t* p = at.reference + first;
    const std::uint8_t* q = at.current + first;
    V16 up = load(p - ref_stride);
    V16 middle = load(p);
    const auto line = [&](int i) { return interpolate_row(q + i * cur_stride); };
    // bilinear uses the middle two only; the compiler removes the others
    SixTaps<V16> lines{line(-2), line(-1), line(0), line(1), line(2), line(0)};
    q += 3 * cur_stride;
    for (int row = 0; row < rows; ++row) {
      const V16 down = load(p + ref_stride);
      const V16 ix = hn::Sub(load(p + 1), load(p - 1));
      const V16 iy = hn::Sub(down, up);
      lines.f = interpolate_row(q);
      V16 warped;
      if constexpr (kFine) {
        warped = weighted(lines, taps_y);
      } else {
        warped = hn::Add(lines.c, hn::MulFixedPoint15(hn::Sub(lines.d, lines.c), linear_y));
      }
      V16 expected = hn::ShiftLeft<6>(middle);
      expected = hn::SaturatedAdd(expected, hn::MulFixedPoint15(expected, gain));
      const V16 r = hn::ShiftRight<2>(hn::SaturatedSub(expected, warped));
      gx = add_products(ix, r, gx);
      gy = add_products(iy, r, gy);
      sr = add_products(r, one, sr);
      if constexpr (kWithContrast) {
        rr = add_products(r, r, rr);
        s0 = add_products(middle, one, s0);
        s00 = add_products(middle, middle, s00);
        s0r = add_products(middle, r, s0r);
      }
      up = middle;
      middle = down;
      lines = {lines.b, lines.c, lines.d, lines.e, lines.f, lines.f};
      p += ref_stride;
      q += cur_stride;
    }
    const auto real = [](V32 v) { return hn::ConvertTo(hn::Rebind<float, D32>(), v); };
    // sum of squares: unsigned, uses all 32 bits for a change from white to black
    const auto signed_rr = real(rr);
    const hn::DFromV<decltype(signed_rr)> df;
    const auto real_rr = hn::IfThenElse(hn::Lt(signed_rr, hn::Zero(df)),
                                        hn::Add(signed_rr, hn::Set(df, 4294967296.0F)), signed_rr);
    const auto with_residual = lane_sums(real(gx), real(gy), real(sr), real_rr);
    s.gx += with_residual[0] / 32;
    s.gy += with_residual[1] / 32;
    s.r += with_residual[2] / 16;
    if constexpr (kWithContrast) {
      const auto brightness_sums = lane_sums(real(s0), real(s00), real(s0r), real(zero));
      s.rr += with_residual[3] / 256;
      s.i0 += brightness_sums[0];
      s.i0i0 += brightness_sums[1];
      s.i0r += brightness_sums[2] / 16;
    }
  }
  return s;
}

// First-order deformation of a shifted tile: r <- r - grad . (A - I) (x - centre).
HWY_INLINE void deform(const TileTexture& t, const Deformation& a, TileSums& s) {
  const float bxx = a.xx - 1, bxy = a.xy, byx = a.yx, byy = a.yy - 1;
  s.gx -= bxx * t.xx.by_x + bxy * t.xx.by_y + byx * t.xy.by_x + byy * t.xy.by_y;
  s.gy -= bxx * t.xy.by_x + bxy * t.xy.by_y + byx * t.yy.by_x + byy * t.yy.by_y;
  s.r -= bxx * t.x.by_x + bxy * t.x.by_y + byx * t.y.by_x + byy * t.y.by_y;
}

// Position of a tile in the current image, in whole pixels and 1/128 px.
struct ShiftedPosition {
  float dx, dy;  // requested shift
  int steps_x, steps_y;
  int x, y;

  [[nodiscard]] bool is_inside(const TileGrid& grid, const ImageView& cur) const {
    return x >= TileGrid::kBefore_px && y >= TileGrid::kBefore_px &&
           x + grid.columns + TileGrid::kAfter_px <= cur.width &&
           y + grid.rows + TileGrid::kAfter_px <= cur.height;
  }
};
HWY_INLINE ShiftedPosition shifted_position(const TileGrid& grid, const TilePlacement& placement,
                                            int i) {
  const auto steps = [](float d) {
    return static_cast<int>(std::floor(std::clamp(d, -1e5F, 1e5F) * 128.0F + 0.5F));
  };
  ShiftedPosition at{};
  at.dx = placement.x_px[i] - grid.centre_x_px[i];
  at.dy = placement.y_px[i] - grid.centre_y_px[i];
  at.steps_x = steps(at.dx);
  at.steps_y = steps(at.dy);
  at.x = grid.left_px[i] + (at.steps_x >> 7);
  at.y = grid.top_px[i] + (at.steps_y >> 7);
  return at;
}

// About twenty short rows of two images: more streams than the hardware prefetcher follows.
HWY_INLINE void fetch_ahead(const ImageView& ref, const ImageView& cur, const TileGrid& grid,
                            const TilePlacement& placement, int i) {
  const ShiftedPosition at = shifted_position(grid, placement, i);
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
                 const TilePlacement& placement, float gain, TileTextures& textures,
                 TileMeasurements& out) {
  constexpr int kAhead = 4;
  const int gain_q15 =
      static_cast<int>(std::lround(std::clamp(gain - 1.0F, -0.99F, 0.99F) * 32768.0F));
  const float pixels = static_cast<float>(grid.columns * grid.rows);
  for (int i = 0; i < grid.count; ++i) {
    if (i + kAhead < grid.count) fetch_ahead(ref, cur, grid, placement, i + kAhead);
    const ShiftedPosition to = shifted_position(grid, placement, i);
    if (!to.is_inside(grid, cur)) {
      store({}, {}, pixels, {}, i, out);
      continue;
    }
    const TilePlace at{ref.data + grid.top_px[i] * ref.stride + grid.left_px[i],
                       cur.data + to.y * cur.stride + to.x, to.steps_x & 127, to.steps_y & 127};
    const Deformation a{placement.axx[i], placement.axy[i], placement.ayx[i], placement.ayy[i]};
    const TileTexture& texture = texture_at<kColumns>(ref, grid, i, textures);
    TileSums sums = shifted_tile<kColumns, kFine, kWithContrast>(at, ref.stride, cur.stride,
                                                                 grid.rows, gain_q15);
    deform(texture, a, sums);
    store(texture, sums, pixels, a, i, out);
    // correction for the rounding of the shift to 1/128 px
    const float ex = static_cast<float>(to.steps_x) / 128.0F - to.dx;
    const float ey = static_cast<float>(to.steps_y) / 128.0F - to.dy;
    out.gx[i] += out.gxx[i] * ex + out.gxy[i] * ey;
    out.gy[i] += out.gxy[i] * ex + out.gyy[i] * ey;
  }
}

void measure_shifted_kernel(const ImageView& ref, const ImageView& cur, const TileGrid& grid,
                            const TilePlacement& placement, float gain, const TileOptions& options,
                            TileTextures& textures, TileMeasurements& out) {
  const auto measure = [&](auto measure_of) {
    measure_of(ref, cur, grid, placement, gain, textures, out);
  };
  const bool wide = grid.columns == 32;
  if (options.quintic) {
    const auto with = wide ? measure_all<32, true, true> : measure_all<16, true, true>;
    const auto without = wide ? measure_all<32, true, false> : measure_all<16, true, false>;
    measure(options.contrast ? with : without);
  } else {
    const auto with = wide ? measure_all<32, false, true> : measure_all<16, false, true>;
    const auto without = wide ? measure_all<32, false, false> : measure_all<16, false, false>;
    measure(options.contrast ? with : without);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace stillkite
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stillkite {

HWY_EXPORT(measure_shifted_kernel);

void measure_shifted(const ImageView& reference, const ImageView& current, const TileGrid& grid,
                     const TilePlacement& placement, float gain, const TileOptions& options,
                     TileTextures& textures, TileMeasurements& out) {
  HWY_DYNAMIC_DISPATCH(measure_shifted_kernel)
  (reference, current, grid, placement, gain, options, textures, out);
}

}  // namespace stillkite
#endif
