#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "geometry/mix_bits.hpp"

namespace stillkite {

/// Random numbers that are the same on every machine (SplitMix64).
class RandomDraws {
 public:
  explicit RandomDraws(std::uint64_t seed) : state_(seed) {}

  /// Uniform over 0 .. count - 1, for a count that is small beside 2^32.
  [[nodiscard]] std::size_t below(std::size_t count) {
    const std::uint64_t high = mix_bits(state_ += kSplitMixStep) >> 32U;
    return static_cast<std::size_t>((high * count) >> 32U);
  }

  /// N different ones of 0 .. count - 1; count >= N.
  template <std::size_t N>
  [[nodiscard]] std::array<std::size_t, N> distinct(std::size_t count) {
    std::array<std::size_t, N> drawn{};
    for (std::size_t i = 0; i < N;) {
      drawn[i] = below(count);
      bool fresh = true;
      for (std::size_t j = 0; j < i; ++j) fresh = fresh && drawn[j] != drawn[i];
      if (fresh) ++i;
    }
    return drawn;
  }

  void shuffle(std::vector<int>& values) {
    for (std::size_t i = values.size(); i > 1; --i) std::swap(values[i - 1], values[below(i)]);
  }

 private:
  std::uint64_t state_;
};

}  // namespace stillkite
