#pragma once

#include <chrono>

#include "geometry/time.hpp"

namespace stillkite {

/// Local monotonic clock; steps of the wall clock do not change it.
[[nodiscard]] inline Timestamp local_now() {
  const auto since = std::chrono::steady_clock::now().time_since_epoch();
  return {std::chrono::duration_cast<std::chrono::nanoseconds>(since).count()};
}

}  // namespace stillkite
