#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "geometry/mix_bits.hpp"

namespace stillkite {

/// Platform-independent random numbers (SplitMix64).
class RandomDraws {
 public:
  explicit RandomDraws(std::uint64_t seed) : state_(seed) {}

  /// Uniform over 0 .. count - 1, for count much smaller than 2^32.
  [[nodiscard]] std::size_t below(std::size_t count) {
    const std::uint64_t high = mix_bits(state_ += kSplitMixStep) >> 32U;
    return static_cast<std::size_t>((high * count) >> 32U);
  }

  /// N distinct indices of 0 .. count - 1; count >= N.
  template <std::size_t N>
  [[nodiscard]] std::array<std::size_t, N> distinct(std::size_t count) {
    std::array<std::size_t, N> drawn{};
    for (std::size_t i = 0; i < N;) {
      drawn[i] = below(count);
      bool is_new = true;
      for (std::size_t j = 0; j < i; ++j) is_new = is_new && drawn[j] != drawn[i];
      if (is_new) ++i;
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
