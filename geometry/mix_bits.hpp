#pragma once

#include <cstdint>

namespace stillkite {

/// Increment of SplitMix64 (Steele, Lea and Flood, "Fast splittable pseudorandom number
/// generators", 2014).
inline constexpr std::uint64_t kSplitMixStep = 0x9e3779b97f4a7c15U;

/// Finalizer (hash) of SplitMix64: decorrelates consecutive inputs.
[[nodiscard]] constexpr std::uint64_t mix_bits(std::uint64_t x) {
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31U);
}

}  // namespace stillkite
