#pragma once

#include <compare>
#include <cstdint>

namespace stillkite {

/// Integer nanoseconds since the epoch of the source.
struct Timestamp {
  std::int64_t ns = 0;
  auto operator<=>(const Timestamp&) const = default;
};

[[nodiscard]] constexpr double seconds_between(Timestamp from, Timestamp to) {
  return static_cast<double>(to.ns - from.ns) * 1e-9;
}

[[nodiscard]] constexpr double to_seconds(Timestamp t) {
  return static_cast<double>(t.ns) * 1e-9;
}

[[nodiscard]] constexpr Timestamp from_seconds(double t_s) {
  return {static_cast<std::int64_t>(t_s * 1e9 + (t_s < 0 ? -0.5 : 0.5))};
}

}  // namespace stillkite
