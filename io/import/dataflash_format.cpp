#include "io/import/dataflash_format.hpp"

#include <algorithm>
#include <cmath>

namespace stillkite {
namespace {

constexpr std::size_t kDataflashHeader = 3;  // 0xA3 0x95 number

// Bytes of a format character; 0 for an unknown one.
std::size_t dataflash_bytes(char type) {
  switch (type) {
    case 'b':
    case 'B':
    case 'M':
      return 1;
    case 'h':
    case 'H':
    case 'c':
    case 'C':
    case 'g':
      return 2;
    case 'i':
    case 'I':
    case 'f':
    case 'e':
    case 'E':
    case 'L':
    case 'n':
      return 4;
    case 'q':
    case 'Q':
    case 'd':
      return 8;
    case 'N':
      return 16;
    case 'a':
    case 'Z':
      return 64;
    default:
      return 0;
  }
}

// Half-precision number, IEEE 754 binary16.
double half(std::uint16_t bits) {
  const int exponent = bits >> 10 & 31;
  const int mantissa = bits & 1023;
  double value = std::ldexp(mantissa, -24);
  if (exponent == 31) value = mantissa == 0 ? INFINITY : NAN;
  if (exponent > 0 && exponent < 31) value = std::ldexp(1024 + mantissa, exponent - 25);
  return (bits >> 15) != 0 ? -value : value;
}

// Text of a fixed width, ended by a zero.
std::string text_at(Bytes message, std::size_t at, std::size_t width) {
  const Bytes part = message.subspan(at, width);
  return {part.begin(), std::find(part.begin(), part.end(), 0)};
}

}  // namespace

const DataflashLayout::Field* DataflashLayout::find(std::string_view field) const {
  const auto found = std::ranges::find(fields, field, &Field::name);
  return found == fields.end() ? nullptr : &*found;
}

std::optional<double> DataflashLayout::number(Bytes message, std::string_view field) const {
  const Field* const found = find(field);
  if (found == nullptr) return std::nullopt;
  const std::size_t at = found->offset;
  switch (found->type) {
    case 'b':
      return little_endian<std::int8_t>(message, at);
    case 'B':
    case 'M':
      return little_endian<std::uint8_t>(message, at);
    case 'h':
      return little_endian<std::int16_t>(message, at);
    case 'H':
      return little_endian<std::uint16_t>(message, at);
    case 'c':
      return little_endian<std::int16_t>(message, at) / 100.0;
    case 'C':
      return little_endian<std::uint16_t>(message, at) / 100.0;
    case 'g':
      return half(little_endian<std::uint16_t>(message, at));
    case 'i':
      return little_endian<std::int32_t>(message, at);
    case 'I':
      return little_endian<std::uint32_t>(message, at);
    case 'e':
      return little_endian<std::int32_t>(message, at) / 100.0;
    case 'E':
      return little_endian<std::uint32_t>(message, at) / 100.0;
    case 'L':
      return little_endian<std::int32_t>(message, at) * 1e-7;
    case 'f':
      return little_endian<float>(message, at);
    case 'd':
      return little_endian<double>(message, at);
    case 'q':
      return static_cast<double>(little_endian<std::int64_t>(message, at));
    case 'Q':
      return static_cast<double>(little_endian<std::uint64_t>(message, at));
    default:
      return std::nullopt;
  }
}

std::optional<std::pair<std::uint8_t, DataflashLayout>> read_dataflash_layout(Bytes message) {
  constexpr std::size_t kName = 5, kFormat = 9, kLabels = 25, kEnd = 89;
  if (message.size() < kEnd) return std::nullopt;
  DataflashLayout layout{.name = text_at(message, kName, 4), .bytes = message[4]};
  const std::string labels = text_at(message, kLabels, 64);
  std::size_t offset = kDataflashHeader;
  std::size_t label = 0;
  for (const char type : text_at(message, kFormat, 16)) {
    const std::size_t bytes = dataflash_bytes(type);
    if (bytes == 0 || label > labels.size()) return std::nullopt;
    const std::size_t end = std::min(labels.find(',', label), labels.size());
    layout.fields.push_back({labels.substr(label, end - label), type, offset});
    label = end + 1;
    offset += bytes;
  }
  if (layout.bytes != offset) return std::nullopt;
  return std::pair(message[3], std::move(layout));
}

}  // namespace stillkite
