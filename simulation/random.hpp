#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace stillkite {

/// Mixes 64 bits so that neighbouring inputs give unrelated outputs (SplitMix64's finalizer).
[[nodiscard]] constexpr std::uint64_t mix_bits(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

/// Random numbers that are the same on every machine and library (SplitMix64, Steele et al. 2014),
/// which those of <random>'s distributions are not. One seed has as many streams as one likes.
class Random {
 public:
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0)
      : state_(mix_bits(seed + kStep * mix_bits(stream + 1))) {}

  [[nodiscard]] std::uint64_t bits() { return mix_bits(state_ += kStep); }
  /// In [0, 1).
  [[nodiscard]] double uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }
  [[nodiscard]] double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Mean 0, variance 1 (Box-Muller).
  [[nodiscard]] double normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }

 private:
  static constexpr std::uint64_t kStep = 0x9e3779b97f4a7c15ULL;
  std::uint64_t state_;
};

}  // namespace stillkite
