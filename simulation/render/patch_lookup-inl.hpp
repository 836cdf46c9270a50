// Texture lookup of a patch sample; compiled once per Highway target as part of the including
// kernel.

#if defined(STILLKITE_PATCH_LOOKUP_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef STILLKITE_PATCH_LOOKUP_INL
#undef STILLKITE_PATCH_LOOKUP_INL
#else
#define STILLKITE_PATCH_LOOKUP_INL
#endif

#include <hwy/highway.h>

#include "simulation/render/patch_kernel.hpp"
#include "simulation/render/texture_sampling-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace stillkite {
namespace HWY_NAMESPACE {

// Reflects a coordinate about the centres of the first and the last texel.
HWY_INLINE VF reflect(VF u, float last) {
  const F f;
  const float period = 2 * last;
  const VF periods = hn::Round(hn::Mul(u, hn::Set(f, 1 / period)));
  return hn::Abs(hn::NegMulAdd(periods, hn::Set(f, period), u));
}

// Four texels around a position: byte offset and bilinear weights.
struct TexelQuad {
  VI offset;
  VF a, b;
};

// Integers n < 2^22 are the low bits of the float 2^23 + n; faster than a saturating conversion.
HWY_INLINE TexelQuad texel_quad(const PatchLevel& level, VF level_u, VF level_v) {
  const F f;
  const U w;
  constexpr float kToBits = 0x1.0p23F;
  constexpr std::uint32_t kBits = 0x4b000000U;  // of kToBits
  const VF zero = hn::Zero(f);
  const VF at_u = hn::Min(hn::Max(level_u, zero), hn::Set(f, level.last_u));
  const VF at_v = hn::Min(hn::Max(level_v, zero), hn::Set(f, level.last_v));
  const VF column = hn::Floor(at_u);
  const VF row = hn::Floor(at_v);
  const VU column_bits = hn::BitCast(w, hn::Add(column, hn::Set(f, kToBits)));
  const VU row_bits = hn::BitCast(w, hn::Add(row, hn::Set(f, kToBits)));
  const VU first = hn::Set(w, level.offset - kBits * (level.pitch + 2));
  const VU along_row = hn::Add(hn::Add(column_bits, column_bits), first);
  const VU offset = hn::Add(hn::Mul(row_bits, hn::Set(w, level.pitch)), along_row);
  return {hn::BitCast(I(), offset), hn::Sub(at_u, column), hn::Sub(at_v, row)};
}

// Texels on a level from coordinates of the finest level.
HWY_INLINE TexelQuad level_texels(const PatchLevel& level, VF u, VF v) {
  const F f;
  const VF scale = hn::Set(f, level.scale);
  const VF shift = hn::Set(f, level.shift);
  return texel_quad(level, hn::MulAdd(u, scale, shift), hn::MulAdd(v, scale, shift));
}

// Pyramid level: floor(log2(footprint) / 2 + round_up). `round_up` varies over the samples of a
// pixel, so that their mean interpolates between two levels with one read per sample.
HWY_INLINE VF level_at(const PatchView& patch, VF depth, float round_up) {
  const F f;
  const VF area =
      hn::Mul(hn::Mul(hn::Mul(depth, depth), depth), hn::Set(f, patch.texels_per_cubed_depth));
  const VF level = hn::MulAdd(approximate_log2(area), hn::Set(f, 0.5F), hn::Set(f, round_up));
  const auto last = static_cast<float>(patch.level_count - 1);
  return hn::Min(hn::Floor(level), hn::Set(f, last));
}

// Single pyramid level of all samples of a patch in a tile; -1 if there are several.
HWY_INLINE int common_level(const PatchCandidate& candidate, float round_up) {
  if (!(candidate.min_inverse_depth > 0)) return -1;
  const F f;
  const auto level = [&](float inverse_depth) HWY_ATTR {
    const VF depth = hn::Set(f, 1.0F / inverse_depth);
    return static_cast<int>(hn::GetLane(level_at(*candidate.view, depth, round_up)));
  };
  const int farthest = level(candidate.min_inverse_depth);
  return level(candidate.max_inverse_depth) == farthest ? farthest : -1;
}

// `only`: the single level of the tile, or null; `visible`: lanes to evaluate.
template <bool kEverywhere>
HWY_INLINE TexelQuad texels_of(const PatchView& patch, VF x, VF y, float round_up, Mask visible,
                               const PatchLevel* only) {
  const F f;
  const I i;
  const VF one = hn::Set(f, 1.0F);
  VF inverse_depth = along(patch.inverse_depth, x, y);
  if constexpr (!kEverywhere) inverse_depth = hn::IfThenElse(visible, inverse_depth, one);
  const VF depth = hn::Div(one, inverse_depth);
  VF u = hn::Mul(depth, along(patch.u, x, y));
  VF v = hn::Mul(depth, along(patch.v, x, y));
  if constexpr (!kEverywhere) {
    u = hn::IfThenElseZero(visible, u);
    v = hn::IfThenElseZero(visible, v);
  }
  if (patch.mirrored) {
    u = reflect(u, patch.levels[0].last_u);
    v = reflect(v, patch.levels[0].last_v);
  }
  if (only != nullptr) return level_texels(*only, u, v);
  const VF level = level_at(patch, depth, round_up);
  const float first = hn::GetLane(level);
  TexelQuad quad = level_texels(patch.levels[static_cast<int>(first)], u, v);
  if (hn::AllTrue(f, hn::Eq(level, hn::Set(f, first)))) return quad;

  const int lowest = static_cast<int>(hn::GetLane(hn::MinOfLanes(f, level)));
  const int highest = static_cast<int>(hn::GetLane(hn::MaxOfLanes(f, level)));
  for (int number = lowest; number <= highest; ++number) {
    const Mask here = hn::Eq(level, hn::Set(f, static_cast<float>(number)));
    if (hn::AllFalse(f, here)) continue;
    const TexelQuad other = level_texels(patch.levels[number], u, v);
    quad = {hn::IfThenElse(hn::RebindMask(i, here), other.offset, quad.offset),
            hn::IfThenElse(here, other.a, quad.a), hn::IfThenElse(here, other.b, quad.b)};
  }
  return quad;
}

}  // namespace HWY_NAMESPACE
}  // namespace stillkite
HWY_AFTER_NAMESPACE();

#endif
