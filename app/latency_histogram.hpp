#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

namespace stillkite {

/// Quantiles of a latency in constant memory, to 0.1 ms.
class LatencyHistogram {
 public:
  void add(double latency_ms) {
    const double bin = std::clamp(latency_ms / kBin_ms, 0.0, static_cast<double>(kBins - 1));
    ++counts_[static_cast<std::size_t>(bin)];
    ++count_;
  }

  /// Nullopt if empty. Latencies above 1 s count as 1 s.
  [[nodiscard]] std::optional<double> quantile_ms(double ratio) const {
    const auto rank = static_cast<std::int64_t>(ratio * static_cast<double>(count_));
    std::int64_t below = 0;
    for (std::size_t bin = 0; bin < kBins; ++bin) {
      below += counts_[bin];
      if (below > rank) return kBin_ms * (static_cast<double>(bin) + 0.5);
    }
    return std::nullopt;
  }

 private:
  static constexpr double kBin_ms = 0.1;
  static constexpr std::size_t kBins = 10'000;
  std::array<std::int64_t, kBins> counts_{};
  std::int64_t count_ = 0;
};

}  // namespace stillkite
