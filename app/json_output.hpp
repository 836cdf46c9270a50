#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "live/link/port.hpp"
#include "navigation/navigation_estimate.hpp"

namespace stillkite {

/// Estimates as JSON lines, on standard output or as one UDP datagram each.
class JsonOutput {
 public:
  /// `target`: - or udp://HOST:PORT. Throws InputError on any other.
  explicit JsonOutput(const std::string& target);

  /// False if standard output is closed. Does not wait: a line that its reader has no room for is
  /// dropped.
  [[nodiscard]] bool send(const NavigationEstimate& estimate);

  [[nodiscard]] std::int64_t dropped() const { return dropped_; }

 private:
  std::int64_t dropped_ = 0;
  std::optional<Port> port_;  // empty: standard output
};

}  // namespace stillkite
