// Bilinear texture samples for the kernels of both renderers; compiled once per Highway target as
// part of the including kernel.

#if defined(STILLKITE_TEXTURE_SAMPLING_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef STILLKITE_TEXTURE_SAMPLING_INL
#undef STILLKITE_TEXTURE_SAMPLING_INL
#else
#define STILLKITE_TEXTURE_SAMPLING_INL
#endif

#include <hwy/highway.h>

#include <array>
#include <cstdint>

#include "simulation/render/bearing_table.hpp"
#include "simulation/render/render_kernel.hpp"

HWY_BEFORE_NAMESPACE();
namespace stillkite {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// The lane cap makes a padded row and a tile row whole numbers of vectors.
static_assert(BearingSegment::kColumns % kRowPadding == 0);
using F = hn::CappedTag<float, kRowPadding>;
using I = hn::RebindToSigned<F>;
using U = hn::RebindToUnsigned<F>;
using VF = hn::Vec<F>;
using VI = hn::Vec<I>;
using VU = hn::Vec<U>;
using Mask = hn::Mask<F>;

// a . (x, y, 1)
HWY_INLINE VF along(const std::array<float, 3>& a, VF x, VF y) {
  const F f;
  return hn::MulAdd(hn::Set(f, a[0]), x, hn::MulAdd(hn::Set(f, a[1]), y, hn::Set(f, a[2])));
}

HWY_INLINE VF blend(VF a, VF b, VF ratio) {
  return hn::MulAdd(ratio, hn::Sub(b, a), a);
}

template <int kShift>
HWY_INLINE VF byte_of(VU quad) {
  VU byte = quad;
  if constexpr (kShift > 0) byte = hn::ShiftRight<kShift>(byte);
  if constexpr (kShift < 24) byte = hn::And(byte, hn::Set(U(), 255U));
  return hn::ConvertTo(F(), hn::BitCast(I(), byte));
}

// Bilinear interpolation in two adjacent pairs of a GroundTexture.
HWY_INLINE VF within_quad(VU quad, VF a, VF b) {
  return blend(blend(byte_of<0>(quad), byte_of<16>(quad), a),
               blend(byte_of<8>(quad), byte_of<24>(quad), a), b);
}

// log2(max(value, 1)), piecewise linear between powers of two: float bits, scaled and shifted.
HWY_INLINE VF approximate_log2(VF value) {
  const F f;
  const VF bits = hn::ConvertTo(f, hn::BitCast(I(), hn::Max(value, hn::Set(f, 1.0F))));
  return hn::MulAdd(bits, hn::Set(f, 0x1.0p-23F), hn::Set(f, -127.0F));
}

}  // namespace HWY_NAMESPACE
}  // namespace stillkite
HWY_AFTER_NAMESPACE();

#endif
