#include "io/import/ulog_format.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <system_error>
#include <utility>

namespace stillkite {
namespace {

struct NamedType {
  std::string_view name;
  UlogType type;
  std::size_t bytes;
};

constexpr std::array kTypes{
    NamedType{"int8_t", UlogType::int8, 1},   NamedType{"uint8_t", UlogType::uint8, 1},
    NamedType{"bool", UlogType::uint8, 1},    NamedType{"char", UlogType::uint8, 1},
    NamedType{"int16_t", UlogType::int16, 2}, NamedType{"uint16_t", UlogType::uint16, 2},
    NamedType{"int32_t", UlogType::int32, 4}, NamedType{"uint32_t", UlogType::uint32, 4},
    NamedType{"int64_t", UlogType::int64, 8}, NamedType{"uint64_t", UlogType::uint64, 8},
    NamedType{"float", UlogType::float32, 4}, NamedType{"double", UlogType::float64, 8}};

const NamedType* find_type(std::string_view name) {
  for (const NamedType& type : kTypes) {
    if (type.name == name) return &type;
  }
  return nullptr;
}

constexpr std::size_t kMaxBytes = 65536;  // of a message

std::size_t bytes_of(UlogType type) {
  for (const NamedType& named : kTypes) {
    if (named.type == type) return named.bytes;
  }
  return 0;
}

}  // namespace

std::optional<double> UlogLayout::number(Bytes message, std::string_view name,
                                         std::size_t index) const {
  const auto found = fields.find(name);
  if (found == fields.end() || index >= found->second.count) return std::nullopt;
  const UlogField& field = found->second;
  const std::size_t at = field.offset + index * bytes_of(field.type);
  if (at + bytes_of(field.type) > message.size()) return std::nullopt;
  switch (field.type) {
    case UlogType::int8:
      return little_endian<std::int8_t>(message, at);
    case UlogType::uint8:
      return little_endian<std::uint8_t>(message, at);
    case UlogType::int16:
      return little_endian<std::int16_t>(message, at);
    case UlogType::uint16:
      return little_endian<std::uint16_t>(message, at);
    case UlogType::int32:
      return little_endian<std::int32_t>(message, at);
    case UlogType::uint32:
      return little_endian<std::uint32_t>(message, at);
    case UlogType::int64:
      return static_cast<double>(little_endian<std::int64_t>(message, at));
    case UlogType::uint64:
      return static_cast<double>(little_endian<std::uint64_t>(message, at));
    case UlogType::float32:
      return little_endian<float>(message, at);
    case UlogType::float64:
      return little_endian<double>(message, at);
  }
  return std::nullopt;
}

std::optional<std::uint64_t> UlogLayout::integer(Bytes message, std::string_view name) const {
  const auto found = fields.find(name);
  if (found == fields.end() || found->second.type != UlogType::uint64) return std::nullopt;
  if (found->second.offset + sizeof(std::uint64_t) > message.size()) return std::nullopt;
  return little_endian<std::uint64_t>(message, found->second.offset);
}

bool UlogFormats::add(std::string_view definition) {
  const std::size_t colon = definition.find(':');
  if (colon == std::string_view::npos || colon == 0) return false;
  std::vector<Member> members;
  std::string_view rest = definition.substr(colon + 1);
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(';'), rest.size());
    const std::string_view member = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (member.empty()) continue;
    const std::size_t blank = member.find(' ');
    if (blank == std::string_view::npos) return false;
    std::string_view type = member.substr(0, blank);
    std::size_t count = 1;
    if (const std::size_t bracket = type.find('['); bracket != std::string_view::npos) {
      const std::string_view number = type.substr(bracket + 1);
      const auto parsed = std::from_chars(number.data(), number.data() + number.size(), count);
      if (parsed.ec != std::errc() || count == 0 || count > kMaxBytes) return false;
      type = type.substr(0, bracket);
    }
    members.push_back({std::string(type), std::string(member.substr(blank + 1)), count});
  }
  if (members.empty()) return false;  // so that the depth and the size bound the nesting
  members_.insert_or_assign(std::string(definition.substr(0, colon)), std::move(members));
  return true;
}

std::optional<std::size_t> UlogFormats::size_of(std::string_view type, int depth) const {
  constexpr int kMaxDepth = 8;
  if (const NamedType* named = find_type(type)) return named->bytes;
  const auto found = members_.find(type);
  if (found == members_.end() || depth >= kMaxDepth) return std::nullopt;
  std::size_t bytes = 0;
  for (const Member& member : found->second) {
    const std::optional<std::size_t> one = size_of(member.type, depth + 1);
    if (!one) return std::nullopt;
    bytes += *one * member.count;
    if (bytes > kMaxBytes) return std::nullopt;
  }
  return bytes;
}

std::optional<UlogLayout> UlogFormats::layout(std::string_view name) const {
  const auto found = members_.find(name);
  if (found == members_.end()) return std::nullopt;
  UlogLayout out;
  std::size_t offset = 0;
  for (const Member& member : found->second) {
    if (const NamedType* type = find_type(member.type)) {
      out.fields.insert_or_assign(
          member.name, UlogField{.type = type->type, .offset = offset, .count = member.count});
    }
    const std::optional<std::size_t> bytes = size_of(member.type, 0);
    if (!bytes || (offset += *bytes * member.count) > kMaxBytes) return std::nullopt;
  }
  return out;
}

}  // namespace stillkite
