#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <functional>

#include "navigation/navigation_estimate.hpp"

namespace stillkite {

/// Wall time from lap to lap.
class StopWatch {
 public:
  double lap_ms() {
    const auto now = std::chrono::steady_clock::now();
    const double ms = std::chrono::duration<double, std::milli>(now - last_).count();
    last_ = now;
    return ms;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// Stage times of two estimators, added.
[[nodiscard]] inline std::array<double, kStageCount> sum_of_stages(
    std::array<double, kStageCount> a, const std::array<double, kStageCount>& b) {
  std::transform(a.begin(), a.end(), b.begin(), a.begin(), std::plus<>());
  return a;
}

}  // namespace stillkite
