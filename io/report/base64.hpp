#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace stillkite {

/// Base64 (RFC 4648, section 4), with padding.
[[nodiscard]] std::string base64(std::span<const std::uint8_t> bytes);

/// Base64 of IEEE floats, little-endian.
[[nodiscard]] std::string base64(std::span<const float> values);

}  // namespace stillkite
