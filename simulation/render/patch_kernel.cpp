#include "simulation/render/patch_kernel.hpp"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simulation/render/patch_kernel.cpp"
#include <hwy/foreach_target.h>
// must follow foreach_target.h
#include <hwy/highway.h>
// highway.h first
#include <hwy/cache_control.h>

#include "simulation/render/patch_lookup-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace stillkite {
namespace HWY_NAMESPACE {

HWY_INLINE VF cubic(const std::array<float, 4>& a, VF t) {
  const F f;
  const VF upper = hn::MulAdd(hn::Set(f, a[3]), t, hn::Set(f, a[2]));
  return hn::MulAdd(hn::MulAdd(upper, t, hn::Set(f, a[1])), t, hn::Set(f, a[0]));
}

constexpr int kColumns = BearingSegment::kColumns;
constexpr int kTilePixels = PatchTile::kRows * kColumns;

// Distance of each column's sample from the segment centre.
using ColumnOffsets = std::array<float, kColumns>;

// Bearings of a vector of pixels from index `first` of the tile.
struct Bearings {
  VF x, y;
};
HWY_INLINE Bearings bearings_at(const PatchTile& tile, const ColumnOffsets& columns, int first) {
  const BearingSegment& segment = *tile.segments[first / kColumns];
  const VF t = hn::Load(F(), &columns[first % kColumns]);
  return {cubic(segment.x, t), cubic(segment.y, t)};
}

// Index of the nearest candidate; -1 without one.
HWY_INLINE VF nearest_of(const PatchTile& tile, VF x, VF y) {
  const F f;
  VF nearest = hn::Zero(f);  // inverse depth
  VF winner = hn::Set(f, -1.0F);
  for (int k = 0; k < tile.candidate_count; ++k) {
    const PatchView& patch = *tile.candidates[k].view;
    const VF inverse_depth = along(patch.inverse_depth, x, y);
    const VF u = along(patch.u, x, y);
    const VF v = along(patch.v, x, y);
    const Mask across = hn::And(hn::Ge(u, hn::Zero(f)),
                                hn::Le(u, hn::Mul(inverse_depth, hn::Set(f, patch.width_texels))));
    const Mask down = hn::And(hn::Ge(v, hn::Zero(f)),
                              hn::Le(v, hn::Mul(inverse_depth, hn::Set(f, patch.height_texels))));
    const Mask wins = hn::And(hn::Gt(inverse_depth, nearest), hn::And(across, down));
    nearest = hn::IfThenElse(wins, inverse_depth, nearest);
    winner = hn::IfThenElse(wins, hn::Set(f, static_cast<float>(k)), winner);
  }
  return winner;
}

// Texel addresses and bilinear weights of a tile's pixels. All addresses are computed and
// prefetched before the first read, which hides the memory latency.
struct TileTexels {
  HWY_ALIGN std::array<std::int32_t, kTilePixels> offset;
  HWY_ALIGN std::array<float, kTilePixels> a;
  HWY_ALIGN std::array<float, kTilePixels> b;
};
HWY_INLINE void store(const PatchView& patch, const TexelQuad& quad, int at, TileTexels& texels) {
  const F f;
  hn::Store(quad.offset, I(), &texels.offset[at]);
  hn::Store(quad.a, f, &texels.a[at]);
  hn::Store(quad.b, f, &texels.b[at]);
  hwy::Prefetch(patch.pairs + texels.offset[at]);
  hwy::Prefetch(patch.pairs + texels.offset[at + static_cast<int>(hn::Lanes(f)) - 1]);
}
HWY_INLINE VF grey_at(const PatchView& patch, const TileTexels& texels, int at) {
  const F f;
  const auto* quads = reinterpret_cast<const std::uint32_t*>(patch.pairs);
  const VU quad = hn::GatherOffset(U(), quads, hn::Load(I(), &texels.offset[at]));
  return within_quad(quad, hn::Load(f, &texels.a[at]), hn::Load(f, &texels.b[at]));
}

// Adds the samples of candidate `number` where it is the nearest (`winners`).
HWY_INLINE void add_patch(const PatchTile& tile, const ColumnOffsets& columns, int number,
                          const float* winners) {
  const F f;
  const int lanes = static_cast<int>(hn::Lanes(f));
  const PatchView& patch = *tile.candidates[number].view;
  const int level = common_level(tile.candidates[number], tile.round_up);
  const PatchLevel only = patch.levels[std::max(0, level)];
  const VF index = hn::Set(f, static_cast<float>(number));
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): written before it is read
  TileTexels texels;
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): written before it is read
  std::array<std::int16_t, kTilePixels> firsts;
  int count = 0;
  // branch-free compaction: the branch would be unpredictable
  for (int first = 0; first < tile.rows * kColumns; first += lanes) {
    firsts[count] = static_cast<std::int16_t>(first);
    count += hn::AllFalse(f, hn::Eq(hn::Load(f, winners + first), index)) ? 0 : 1;
  }
  for (int k = 0; k < count; ++k) {
    const Mask visible = hn::Eq(hn::Load(f, winners + firsts[k]), index);
    const Bearings bearing = bearings_at(tile, columns, firsts[k]);
    const TexelQuad quad = texels_of<false>(patch, bearing.x, bearing.y, tile.round_up, visible,
                                            level < 0 ? nullptr : &only);
    store(patch, quad, lanes * k, texels);
  }
  for (int k = 0; k < count; ++k) {
    float* grey = tile.grey + firsts[k];
    const Mask visible = hn::Eq(hn::Load(f, winners + firsts[k]), index);
    const VF value = hn::IfThenElseZero(visible, grey_at(patch, texels, lanes * k));
    hn::StoreU(hn::Add(hn::LoadU(f, grey), value), f, grey);
  }
}

// Linear function of the bearing along a segment; cubic, as both coordinates are.
HWY_INLINE std::array<float, 4> cubic_along(const std::array<float, 3>& a,
                                            const BearingSegment& segment) {
  std::array<float, 4> out{};
  for (int k = 0; k < 4; ++k) out[k] = a[0] * segment.x[k] + a[1] * segment.y[k];
  out[0] += a[2];
  return out;
}

// Linear function of a texel coordinate x inverse depth, from the finest level to `level`.
HWY_INLINE std::array<float, 3> on_level(const PatchLevel& level, const std::array<float, 3>& a,
                                         const std::array<float, 3>& inverse_depth) {
  std::array<float, 3> out{};
  for (int k = 0; k < 3; ++k) out[k] = level.scale * a[k] + level.shift * inverse_depth[k];
  return out;
}

// Texels of a patch that covers the tile on a single pyramid level.
HWY_INLINE void find_level_texels(const PatchTile& tile, const ColumnOffsets& columns,
                                  const PatchLevel& level, TileTexels& texels) {
  const F f;
  const PatchView& patch = *tile.candidates[0].view;
  const std::array<float, 3> level_u = on_level(level, patch.u, patch.inverse_depth);
  const std::array<float, 3> level_v = on_level(level, patch.v, patch.inverse_depth);
  for (int row = 0; row < tile.rows; ++row) {
    const BearingSegment& segment = *tile.segments[row];
    const std::array<float, 4> u = cubic_along(level_u, segment);
    const std::array<float, 4> v = cubic_along(level_v, segment);
    const std::array<float, 4> inverse_depth = cubic_along(patch.inverse_depth, segment);
    for (int column = 0; column < kColumns; column += static_cast<int>(hn::Lanes(f))) {
      const VF t = hn::Load(f, &columns[column]);
      const VF depth = hn::Div(hn::Set(f, 1.0F), cubic(inverse_depth, t));
      const TexelQuad quad =
          texel_quad(level, hn::Mul(depth, cubic(u, t)), hn::Mul(depth, cubic(v, t)));
      store(patch, quad, row * kColumns + column, texels);
    }
  }
}

// Adds the samples of the patch that covers the tile.
HWY_INLINE void add_cover(const PatchTile& tile, const ColumnOffsets& columns) {
  const F f;
  const int lanes = static_cast<int>(hn::Lanes(f));
  const PatchView& patch = *tile.candidates[0].view;
  const int level = common_level(tile.candidates[0], tile.round_up);
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): written before it is read
  TileTexels texels;
  if (level >= 0 && !patch.mirrored) {
    find_level_texels(tile, columns, patch.levels[level], texels);
  } else {
    const Mask everywhere = hn::Eq(hn::Zero(f), hn::Zero(f));
    for (int first = 0; first < tile.rows * kColumns; first += lanes) {
      const Bearings bearing = bearings_at(tile, columns, first);
      store(patch, texels_of<true>(patch, bearing.x, bearing.y, tile.round_up, everywhere, nullptr),
            first, texels);
    }
  }
  for (int first = 0; first < tile.rows * kColumns; first += lanes) {
    float* grey = tile.grey + first;
    hn::StoreU(hn::Add(hn::LoadU(f, grey), grey_at(patch, texels, first)), f, grey);
  }
}

void add_tile_kernel(const PatchTile& tile) {
  const F f;
  const int lanes = static_cast<int>(hn::Lanes(f));
  HWY_ALIGN ColumnOffsets columns;
  for (int first = 0; first < kColumns; first += lanes) {
    const float from_middle = static_cast<float>(first) - 0.5F * (kColumns - 1) + tile.offset;
    hn::Store(hn::Iota(f, from_middle), f, &columns[first]);
  }
  if (tile.covered) return add_cover(tile, columns);

  const VF background = hn::Set(f, tile.background_grey);
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): written before it is read
  HWY_ALIGN std::array<float, kTilePixels> winners;
  for (int first = 0; first < tile.rows * kColumns; first += lanes) {
    const Bearings bearing = bearings_at(tile, columns, first);
    const VF winner = nearest_of(tile, bearing.x, bearing.y);
    hn::Store(winner, f, &winners[first]);
    const VF sum = hn::LoadU(f, tile.grey + first);
    const VF uncovered = hn::IfThenElseZero(hn::Lt(winner, hn::Zero(f)), background);
    hn::StoreU(hn::Add(sum, uncovered), f, tile.grey + first);
  }
  for (int k = 0; k < tile.candidate_count; ++k) add_patch(tile, columns, k, winners.data());
}

}  // namespace HWY_NAMESPACE
}  // namespace stillkite
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stillkite {

HWY_EXPORT(add_tile_kernel);

void add_tile(const PatchTile& tile) {
  HWY_DYNAMIC_DISPATCH(add_tile_kernel)(tile);
}

}  // namespace stillkite
#endif
