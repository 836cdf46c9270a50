#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace stillkite {

/// RFC 4648, section 4, with padding.
[[nodiscard]] std::string base64(std::span<const std::uint8_t> bytes);

/// The same of IEEE floats, little-endian.
[[nodiscard]] std::string base64(std::span<const float> values);

}  // namespace stillkite
