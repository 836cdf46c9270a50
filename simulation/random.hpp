#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "geometry/mix_bits.hpp"

namespace stillkite {

/// Pseudo-random numbers (SplitMix64) identical on every platform; the distributions of <random>
/// are implementation-defined. Streams of one seed are independent.
class Random {
 public:
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0)
      : state_(mix_bits(seed + kSplitMixStep * mix_bits(stream + 1))) {}

  [[nodiscard]] std::uint64_t bits() { return mix_bits(state_ += kSplitMixStep); }
  /// In [0, 1).
  [[nodiscard]] double uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }
  [[nodiscard]] double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Mean 0, variance 1 (Box-Muller).
  [[nodiscard]] double normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }

 private:
  std::uint64_t state_;
};

}  // namespace stillkite
