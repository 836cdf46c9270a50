// Tile sums that depend on the reference only. Compiled once per Highway target as part of the
// kernels that include this file.

#if defined(STILLKITE_TILE_TEXTURE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef STILLKITE_TILE_TEXTURE_INL
#undef STILLKITE_TILE_TEXTURE_INL
#else
#define STILLKITE_TILE_TEXTURE_INL
#endif

#include <hwy/highway.h>

#include <array>

#include "flow/tile_sums.hpp"

HWY_BEFORE_NAMESPACE();
namespace stillkite {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// sum + products of a and b, added in pairs of adjacent lanes.
template <class V16, class V32>
HWY_INLINE V32 add_products(V16 a, V16 b, V32 sum) {
  const hn::DFromV<V32> d;
  V32 odd = hn::Zero(d);
  sum = hn::ReorderWidenMulAccumulate(d, a, b, sum, odd);
  return hn::Add(sum, odd);
}

// Horizontal sums of four vectors. Interleaving them needs half the operations of four reductions.
#if HWY_TARGET == HWY_SCALAR || HWY_HAVE_SCALABLE
template <class VF>
HWY_INLINE std::array<float, 4> lane_sums(VF a, VF b, VF c, VF e) {
  const auto total = [](VF v) { return hn::GetLane(hn::SumOfLanes(hn::DFromV<VF>(), v)); };
  return {total(a), total(b), total(c), total(e)};
}
#else
template <class VF>
HWY_INLINE std::array<float, 4> sum_of_blocks(VF sums) {
  const hn::DFromV<VF> d;
  if constexpr (hn::MaxLanes(d) > 4) {
    const hn::Half<decltype(d)> half;
    return sum_of_blocks(hn::Add(hn::LowerHalf(half, sums), hn::UpperHalf(half, sums)));
  } else {
    std::array<float, 4> out{};
    hn::StoreU(sums, d, out.data());
    return out;
  }
}
template <class VF>
HWY_INLINE std::array<float, 4> lane_sums(VF a, VF b, VF c, VF e) {
  const hn::DFromV<VF> d;
  const hn::Repartition<double, decltype(d)> pairs;
  const VF ab = hn::Add(hn::InterleaveLower(d, a, b), hn::InterleaveUpper(d, a, b));
  const VF ce = hn::Add(hn::InterleaveLower(d, c, e), hn::InterleaveUpper(d, c, e));
  const auto pairs_ab = hn::BitCast(pairs, ab), pairs_ce = hn::BitCast(pairs, ce);
  return sum_of_blocks(hn::Add(hn::BitCast(d, hn::InterleaveLower(pairs, pairs_ab, pairs_ce)),
                               hn::BitCast(d, hn::InterleaveUpper(pairs, pairs_ab, pairs_ce))));
}
#endif

// Sum per pair of columns, and the running total of that sum, which gives the moment along y. The
// moment along x treats a pair as one column.
template <class V32>
struct Moments {
  V32 sum;
  V32 running;

  HWY_INLINE void add(V32 increased) {
    sum = increased;
    running = hn::Add(running, increased);
  }
};

// Gradients: differences over two pixels in 16-bit lanes. Products: sums in 32-bit lanes, one per
// pair of columns.
template <int kColumns>
TileTexture texture_of(const std::uint8_t* reference, std::ptrdiff_t stride, int rows) {
  using D16 = hn::CappedTag<std::int16_t, kColumns>;
  using D32 = hn::RepartitionToWide<D16>;
  using DF = hn::Rebind<float, D32>;
  using V16 = hn::Vec<D16>;
  using V32 = hn::Vec<D32>;
  using VF = hn::Vec<DF>;
  const D16 d;
  const hn::Rebind<std::uint8_t, D16> d8;
  const auto load = [&](const std::uint8_t* p) { return hn::PromoteTo(d, hn::LoadU(d8, p)); };
  const V16 one = hn::Set(d, 1);
  TileTexture out;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int first = 0; first < kColumns; first += lanes) {
    const V32 zero = hn::Zero(D32());
    Moments<V32> xx{zero, zero}, xy{zero, zero}, yy{zero, zero}, x{zero, zero}, y{zero, zero};
    const std::uint8_t* p = reference + first;
    V16 up = load(p - stride);
    V16 middle = load(p);
    for (int row = 0; row < rows; ++row) {
      const V16 down = load(p + stride);
      const V16 ix = hn::Sub(load(p + 1), load(p - 1));
      const V16 iy = hn::Sub(down, up);
      xx.add(add_products(ix, ix, xx.sum));
      xy.add(add_products(ix, iy, xy.sum));
      yy.add(add_products(iy, iy, yy.sum));
      x.add(add_products(ix, one, x.sum));
      y.add(add_products(iy, one, y.sum));
      up = middle;
      middle = down;
      p += stride;
    }
    // lane k holds the columns (2 k, 2 k + 1)
    const VF column = hn::MulAdd(
        hn::Iota(DF(), 0.0F), hn::Set(DF(), 2.0F),
        hn::Set(DF(), static_cast<float>(first) - 0.5F * static_cast<float>(kColumns) + 1));
    const auto real = [&](V32 v) { return hn::ConvertTo(DF(), v); };
    const VF fxx = real(xx.sum), fxy = real(xy.sum), fyy = real(yy.sum), fx = real(x.sum),
             fy = real(y.sum);
    const auto sum = lane_sums(fxx, fxy, fyy, fx);
    const auto by_x = lane_sums(hn::Mul(fxx, column), hn::Mul(fxy, column), hn::Mul(fyy, column),
                                hn::Mul(fx, column));
    const auto running =
        lane_sums(real(xx.running), real(xy.running), real(yy.running), real(x.running));
    const auto y_sums = lane_sums(fy, hn::Mul(fy, column), real(y.running), hn::Zero(DF()));
    // row k is contained rows - k times in the running total
    const float last = 0.5F * static_cast<float>(rows + 1);
    const auto add = [&](TileMoments& m, float scale, float total, float moment_x,
                         float running_total) {
      m.sum += scale * total;
      m.by_x += scale * moment_x;
      m.by_y += scale * (last * total - running_total);
    };
    add(out.xx, 0.25F, sum[0], by_x[0], running[0]);
    add(out.xy, 0.25F, sum[1], by_x[1], running[1]);
    add(out.yy, 0.25F, sum[2], by_x[2], running[2]);
    add(out.x, 0.5F, sum[3], by_x[3], running[3]);
    add(out.y, 0.5F, y_sums[0], y_sums[1], y_sums[2]);
  }
  return out;
}

// Computes the texture on first use.
template <int kColumns>
HWY_INLINE const TileTexture& texture_at(const ImageView& reference, const TileGrid& grid, int i,
                                         TileTextures& textures) {
  const auto k = static_cast<std::size_t>(i);
  if (textures.computed[k] == 0) {
    textures.computed[k] = 1;
    textures.tiles[k] =
        texture_of<kColumns>(reference.data + grid.top_px[k] * reference.stride + grid.left_px[k],
                             reference.stride, grid.rows);
  }
  return textures.tiles[k];
}

}  // namespace HWY_NAMESPACE
}  // namespace stillkite
HWY_AFTER_NAMESPACE();

#endif
