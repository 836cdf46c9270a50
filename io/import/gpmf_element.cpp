#include "io/import/gpmf_element.hpp"

#include <algorithm>
#include <cstdint>

namespace stillkite {
namespace {

constexpr std::size_t kGpmfHeader = 8;

std::size_t gpmf_bytes(char type) {
  switch (type) {
    case 'b':
    case 'B':
      return 1;
    case 's':
    case 'S':
      return 2;
    case 'l':
    case 'L':
    case 'f':
    case 'q':
      return 4;
    case 'd':
    case 'j':
    case 'J':
    case 'Q':
      return 8;
    default:
      return 0;
  }
}

double gpmf_number(Bytes data, std::size_t at, char type) {
  switch (type) {
    case 'b':
      return big_endian<std::int8_t>(data, at);
    case 'B':
      return big_endian<std::uint8_t>(data, at);
    case 's':
      return big_endian<std::int16_t>(data, at);
    case 'S':
      return big_endian<std::uint16_t>(data, at);
    case 'l':
      return big_endian<std::int32_t>(data, at);
    case 'L':
      return big_endian<std::uint32_t>(data, at);
    case 'f':
      return big_endian<float>(data, at);
    case 'd':
      return big_endian<double>(data, at);
    case 'j':
      return static_cast<double>(big_endian<std::int64_t>(data, at));
    case 'J':
      return static_cast<double>(big_endian<std::uint64_t>(data, at));
    case 'q':  // fixed point
      return big_endian<std::int32_t>(data, at) / 65536.0;
    default:  // Q
      return static_cast<double>(big_endian<std::int64_t>(data, at)) / 4294967296.0;
  }
}

}  // namespace

std::string_view GpmfElement::text() const {
  const std::string_view all(reinterpret_cast<const char*>(data.data()), data.size());
  return all.substr(0, all.find('\0'));
}

std::vector<double> GpmfElement::numbers(std::size_t structure, std::string_view types) const {
  std::vector<double> out;
  std::size_t at = structure * size;
  const std::size_t end = at + size;
  if (end > data.size()) return out;
  for (std::size_t i = 0; at < end; ++i) {
    const char type_here = type == '?' ? (i < types.size() ? types[i] : '\0') : type;
    const std::size_t bytes = gpmf_bytes(type_here);
    if (bytes == 0 || at + bytes > end) break;
    out.push_back(gpmf_number(data, at, type_here));
    at += bytes;
  }
  return out;
}

std::optional<GpmfElement> take_gpmf(Bytes& bytes) {
  if (bytes.size() < kGpmfHeader) return std::nullopt;
  const std::size_t size = bytes[5];
  const std::size_t repeat = big_endian<std::uint16_t>(bytes, 6);
  const std::size_t length = size * repeat;
  if (length > bytes.size() - kGpmfHeader || bytes[0] == 0) return std::nullopt;
  const GpmfElement element{.key = {reinterpret_cast<const char*>(bytes.data()), 4},
                            .type = static_cast<char>(bytes[4]),
                            .size = size,
                            .repeat = repeat,
                            .data = bytes.subspan(kGpmfHeader, length)};
  const std::size_t padded = (length + 3) / 4 * 4;
  bytes = bytes.subspan(std::min(kGpmfHeader + padded, bytes.size()));
  return element;
}

}  // namespace stillkite
