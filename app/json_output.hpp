#pragma once

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

  /// Throws std::runtime_error if standard output is closed.
  void send(const NavigationEstimate& estimate);

 private:
  std::optional<Port> port_;  // empty: standard output
};

}  // namespace stillkite
