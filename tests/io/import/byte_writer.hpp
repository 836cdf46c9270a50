#pragma once

#include <algorithm>
#include <cstring>
#include <string>
#include <string_view>

namespace stillkite {

/// Bytes of a recording that a test makes.
struct ByteWriter {
  std::string bytes;

  template <typename T>
  ByteWriter& little(T value) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    bytes.append(raw, sizeof(T));
    return *this;
  }
  template <typename T>
  ByteWriter& big(T value) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    std::reverse(raw, raw + sizeof(T));
    bytes.append(raw, sizeof(T));
    return *this;
  }
  ByteWriter& text(std::string_view value) {
    bytes.append(value);
    return *this;
  }
  /// Text, filled up with zeros.
  ByteWriter& text(std::string_view value, std::size_t width) {
    bytes.append(value).append(width - value.size(), '\0');
    return *this;
  }
};

}  // namespace stillkite
