#include "simulation/patch_kernel.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simulation/patch_kernel.cpp"
#include <hwy/foreach_target.h>
// must follow foreach_target.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace stillkite {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// A row of a tile is a whole number of vectors.
using F = hn::CappedTag<float, BearingSegment::kColumns>;
using I = hn::RebindToSigned<F>;
using U = hn::RebindToUnsigned<F>;
using VF = hn::Vec<F>;
using VI = hn::Vec<I>;
using VU = hn::Vec<U>;
using Mask = hn::Mask<F>;

HWY_INLINE VF along(const std::array<float, 3>& a, VF x, VF y) {
  const F f;
  return hn::MulAdd(hn::Set(f, a[0]), x, hn::MulAdd(hn::Set(f, a[1]), y, hn::Set(f, a[2])));
}

HWY_INLINE VF blend(VF a, VF b, VF ratio) {
  return hn::MulAdd(ratio, hn::Sub(b, a), a);
}

template <int kShift>
HWY_INLINE VF byte_of(VU quad) {
  const VU shifted = hn::And(hn::ShiftRight<kShift>(quad), hn::Set(U(), 255U));
  return hn::ConvertTo(F(), hn::BitCast(I(), shifted));
}

HWY_INLINE VF within_quad(VU quad, VF a, VF b) {
  return blend(blend(byte_of<0>(quad), byte_of<8>(quad), a),
               blend(byte_of<16>(quad), byte_of<24>(quad), a), b);
}

// A coordinate reflected about the centres of the first and the last texel.
HWY_INLINE VF reflect(VF u, int size) {
  const F f;
  const float period = 2 * static_cast<float>(size - 1);
  const VF turns = hn::Round(hn::Mul(u, hn::Set(f, 1 / period)));
  return hn::Abs(hn::NegMulAdd(turns, hn::Set(f, period), u));
}

// One pyramid level at coordinates of the finest one.
HWY_INLINE VF sample(const PatchView& patch, int number, VF u, VF v) {
  const F f;
  const I i;
  const GroundTexture::Level& level = patch.levels[number];
  const VF half = hn::Set(f, 0.5F);
  const VF scale = hn::Set(f, 1.0F / static_cast<float>(1 << number));
  const VF last_u = hn::Set(f, static_cast<float>(level.width - 1));
  const VF last_v = hn::Set(f, static_cast<float>(level.height - 1));
  const VF at_u = hn::Min(hn::Max(hn::MulSub(hn::Add(u, half), scale, half), hn::Zero(f)), last_u);
  const VF at_v = hn::Min(hn::Max(hn::MulSub(hn::Add(v, half), scale, half), hn::Zero(f)), last_v);
  const VI column = hn::ConvertTo(i, at_u);
  const VI row = hn::ConvertTo(i, at_v);
  const VI index = hn::Add(hn::Mul(row, hn::Set(i, level.pitch)), column);
  const VU quad = hn::GatherIndex(U(), patch.words + level.offset, index);
  return within_quad(quad, hn::Sub(at_u, hn::ConvertTo(f, column)),
                     hn::Sub(at_v, hn::ConvertTo(f, row)));
}

// From the pyramid level of the logarithm of the footprint, rounded up for as many samples of a
// pixel as its fraction says: their mean goes over from level to level, for one read a sample.
// `seen`: where it matters.
HWY_INLINE VF shade(const PatchView& patch, VF x, VF y, float round_up, Mask seen) {
  const F f;
  const I i;
  const VF inverse_depth = hn::IfThenElse(seen, along(patch.inverse_depth, x, y), hn::Set(f, 1.0F));
  const VF depth = hn::Div(hn::Set(f, 1.0F), inverse_depth);
  VF u = hn::IfThenElseZero(seen, hn::Mul(depth, along(patch.u, x, y)));
  VF v = hn::IfThenElseZero(seen, hn::Mul(depth, along(patch.v, x, y)));
  if (patch.mirrored) {
    u = reflect(u, patch.levels[0].width);
    v = reflect(v, patch.levels[0].height);
  }
  const VF area =
      hn::Mul(hn::Mul(hn::Mul(depth, depth), depth), hn::Set(f, patch.texels_per_cubed_depth));
  // the bits of a float are, but for scale and offset, its logarithm, linear between powers of two
  const VF bits = hn::ConvertTo(f, hn::BitCast(i, hn::Max(area, hn::Set(f, 1.0F))));
  const VF logarithm = hn::MulAdd(bits, hn::Set(f, 0x1.0p-24F), hn::Set(f, -63.5F));
  const auto last = static_cast<float>(patch.level_count - 1);
  const VF level = hn::Min(hn::Floor(hn::Add(logarithm, hn::Set(f, round_up))), hn::Set(f, last));
  const float first = hn::GetLane(level);
  if (hn::AllTrue(f, hn::Eq(level, hn::Set(f, first)))) {
    return sample(patch, static_cast<int>(first), u, v);
  }
  const int lowest = static_cast<int>(hn::GetLane(hn::MinOfLanes(f, level)));
  const int highest = static_cast<int>(hn::GetLane(hn::MaxOfLanes(f, level)));
  VF grey = hn::Zero(f);
  for (int number = lowest; number <= highest; ++number) {
    const Mask here = hn::And(seen, hn::Eq(level, hn::Set(f, static_cast<float>(number))));
    if (hn::AllFalse(f, here)) continue;
    grey = hn::IfThenElse(here, sample(patch, number, u, v), grey);
  }
  return grey;
}

HWY_INLINE VF nearest_of(const PatchTileRow& row, VF x, VF y, float round_up) {
  const F f;
  VF nearest = hn::Zero(f);  // in inverse depth
  VF winner = hn::Set(f, -1.0F);
  for (int k = 0; k < row.candidate_count; ++k) {
    const PatchView& patch = *row.candidates[k];
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
  VF grey = hn::Set(f, row.background_grey);
  for (int k = 0; k < row.candidate_count; ++k) {
    const Mask seen = hn::Eq(winner, hn::Set(f, static_cast<float>(k)));
    if (hn::AllFalse(f, seen)) continue;
    grey = hn::IfThenElse(seen, shade(*row.candidates[k], x, y, round_up, seen), grey);
    if (hn::AllTrue(f, seen)) break;
  }
  return grey;
}

HWY_INLINE VF cubic(const std::array<float, 4>& a, VF t) {
  const F f;
  const VF upper = hn::MulAdd(hn::Set(f, a[3]), t, hn::Set(f, a[2]));
  return hn::MulAdd(hn::MulAdd(upper, t, hn::Set(f, a[1])), t, hn::Set(f, a[0]));
}

void add_row(const PatchTileRow& row) {
  const F f;
  const Mask everywhere = hn::Eq(hn::Zero(f), hn::Zero(f));
  constexpr int kColumns = BearingSegment::kColumns;
  for (int column = 0; column < kColumns; column += static_cast<int>(hn::Lanes(f))) {
    const VF pixel = hn::Iota(f, static_cast<float>(column) - 0.5F * (kColumns - 1));
    VF sum = hn::LoadU(f, row.grey + column);
    for (int k = 0; k < row.samples; ++k) {
      const VF t = hn::Add(pixel, hn::Set(f, row.offsets[k]));
      const VF x = cubic(row.segments[k]->x, t);
      const VF y = cubic(row.segments[k]->y, t);
      sum = hn::Add(sum, row.covered ? shade(*row.candidates[0], x, y, row.round_up[k], everywhere)
                                     : nearest_of(row, x, y, row.round_up[k]));
    }
    hn::StoreU(sum, f, row.grey + column);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace stillkite
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stillkite {

HWY_EXPORT(add_row);

void add_tile_row(const PatchTileRow& row) {
  HWY_DYNAMIC_DISPATCH(add_row)(row);
}

}  // namespace stillkite
#endif
