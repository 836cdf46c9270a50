#include "simulation/render/develop_kernel.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simulation/render/develop_kernel.cpp"
#include <hwy/foreach_target.h>
// must follow foreach_target.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace stillkite {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using F = hn::CappedTag<float, kDevelopPadding>;
using U = hn::RebindToUnsigned<F>;
using I = hn::RebindToSigned<F>;
using VU = hn::Vec<U>;

// 32-bit integer hash with low bias (C. Wellons, "lowbias32").
HWY_INLINE VU mix_bits_32(VU x) {
  const U u;
  x = hn::Xor(x, hn::ShiftRight<16>(x));
  x = hn::Mul(x, hn::Set(u, 0x7feb352dU));
  x = hn::Xor(x, hn::ShiftRight<15>(x));
  x = hn::Mul(x, hn::Set(u, 0x846ca68bU));
  return hn::Xor(x, hn::ShiftRight<16>(x));
}

// Sums byte 0 + byte 1 in the lower and byte 2 + byte 3 in the upper half of a word.
HWY_INLINE VU add_bytes(VU x) {
  const VU mask = hn::Set(U(), 0x00ff00ffU);
  return hn::Add(hn::And(x, mask), hn::And(hn::ShiftRight<8>(x), mask));
}

template <bool kPhotonNoise>
void develop(const DevelopRow& row) {
  const F f;
  const I i;
  const U u;
  // eight uniform bytes: mean 8 x 127.5, variance 8 (256^2 - 1) / 12
  constexpr float kMean = 1020;
  constexpr float kDeviation = 209.0219F;
  const auto gain = hn::Set(f, row.gain);
  const auto read_grey_per_count = hn::Set(f, row.noise_grey / kDeviation);
  const auto read_variance = hn::Mul(read_grey_per_count, read_grey_per_count);
  const auto photon_variance = hn::Set(f, row.photon_variance_per_grey / (kDeviation * kDeviation));
  const auto key_1 = hn::Set(u, row.key_1);
  const auto key_2 = hn::Set(u, row.key_2);
  const VU lane = hn::Iota(u, 0);
  for (int k = 0; k < row.count; k += static_cast<int>(hn::Lanes(f))) {
    const VU pixel = hn::Add(lane, hn::Set(u, row.first_pixel + static_cast<std::uint32_t>(k)));
    const VU hash_1 = mix_bits_32(hn::Add(mix_bits_32(hn::Xor(pixel, key_1)), key_2));
    const VU hash_2 = mix_bits_32(hn::Xor(hash_1, key_1));
    const VU pairs = hn::Add(add_bytes(hash_1), add_bytes(hash_2));
    const VU sum = hn::Add(hn::And(pairs, hn::Set(u, 0xffffU)), hn::ShiftRight<16>(pairs));
    const auto irradiance = hn::LoadU(f, row.irradiance + k);
    auto grey_per_count = read_grey_per_count;
    if constexpr (kPhotonNoise) {
      grey_per_count =
          hn::Sqrt(hn::MulAdd(hn::Mul(gain, irradiance), photon_variance, read_variance));
    }
    const auto noise =
        hn::Mul(hn::Sub(hn::ConvertTo(f, hn::BitCast(i, sum)), hn::Set(f, kMean)), grey_per_count);
    const auto grey = hn::MulAdd(gain, irradiance, noise);
    const hn::Rebind<std::uint8_t, I> bytes;
    hn::StoreU(hn::DemoteTo(bytes, hn::NearestInt(grey)), bytes, row.grey + k);
  }
}

void develop_dispatched(const DevelopRow& row) {
  if (row.photon_variance_per_grey > 0) return develop<true>(row);
  develop<false>(row);
}

}  // namespace HWY_NAMESPACE
}  // namespace stillkite
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stillkite {

HWY_EXPORT(develop_dispatched);

void develop_row(const DevelopRow& row) {
  HWY_DYNAMIC_DISPATCH(develop_dispatched)(row);
}

}  // namespace stillkite
#endif
