#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace stillkite::fuzz {

using Input = std::span<const std::uint8_t>;

/// Violated property of a reader's result.
struct Finding : std::logic_error {
  using std::logic_error::logic_error;
};

inline void require(bool holds, const char* property) {
  if (!holds) throw Finding(property);
}

/// Reader of bytes that other programs write.
struct Target {
  std::string_view name;
  void (*read)(Input);  ///< throws Finding; any other exception is a finding, too
  /// Inputs of a binary format; further ones, and those of earlier findings, are files of
  /// corpus/NAME.
  std::vector<std::string> (*seeds)() = [] { return std::vector<std::string>(); };
};

[[nodiscard]] std::span<const Target> live_targets();
[[nodiscard]] std::span<const Target> import_targets();

/// All of the above.
[[nodiscard]] std::vector<Target> targets();

[[nodiscard]] inline std::string_view text_of(Input input) {
  return {reinterpret_cast<const char*>(input.data()), input.size()};
}

}  // namespace stillkite::fuzz
