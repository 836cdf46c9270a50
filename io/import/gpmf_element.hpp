#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/import/byte_source.hpp"

namespace stillkite {

/// Element of GoPro's metadata format (GPMF): four-character key, and `repeat` structures of `size`
/// bytes of one type, most significant byte first.
struct GpmfElement {
  std::string_view key;
  char type = 0;  ///< 0: nested elements
  std::size_t size = 0;
  std::size_t repeat = 0;
  Bytes data;  ///< without padding

  [[nodiscard]] bool is_nested() const { return type == 0; }
  [[nodiscard]] std::string_view text() const;
  /// Numbers of one structure, as `types` (of a TYPE element) or its own type define. Empty for
  /// text, an unknown type and a structure beyond the data.
  [[nodiscard]] std::vector<double> numbers(std::size_t structure,
                                            std::string_view types = {}) const;
};

/// Takes the next element from the front of the bytes; nullopt at the end and if it is cut off.
[[nodiscard]] std::optional<GpmfElement> take_gpmf(Bytes& bytes);

}  // namespace stillkite
