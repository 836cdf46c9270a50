#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace stillkite::mavlink {

static_assert(std::endian::native == std::endian::little, "fields are copied as on the wire");

inline constexpr std::size_t kMaxPayload_bytes = 255;

/// Checksum of MAVLink: CRC-16/MCRF4XX (X.25 polynomial, initial value 0xffff).
class Checksum {
 public:
  constexpr void add(std::uint8_t byte) {
    std::uint8_t t = byte ^ static_cast<std::uint8_t>(crc_ & 0xff);
    t = static_cast<std::uint8_t>(t ^ (t << 4));
    crc_ = static_cast<std::uint16_t>((crc_ >> 8) ^ (t << 8) ^ (t << 3) ^ (t >> 4));
  }
  constexpr void add(std::string_view text) {
    for (const char c : text) add(static_cast<std::uint8_t>(c));
  }
  [[nodiscard]] constexpr std::uint16_t value() const { return crc_; }

 private:
  std::uint16_t crc_ = 0xffff;
};

/// Name of a field's type in the message definitions.
template <typename T>
[[nodiscard]] constexpr std::string_view type_name() {
  if constexpr (std::same_as<T, float>) return "float";
  if constexpr (std::same_as<T, char>) return "char";
  if constexpr (std::same_as<T, std::uint8_t>) return "uint8_t";
  if constexpr (std::same_as<T, std::int8_t>) return "int8_t";
  if constexpr (std::same_as<T, std::uint16_t>) return "uint16_t";
  if constexpr (std::same_as<T, std::int16_t>) return "int16_t";
  if constexpr (std::same_as<T, std::uint32_t>) return "uint32_t";
  if constexpr (std::same_as<T, std::int32_t>) return "int32_t";
  if constexpr (std::same_as<T, std::uint64_t>) return "uint64_t";
  if constexpr (std::same_as<T, std::int64_t>) return "int64_t";
}

/// Element type and number of elements of a field.
template <typename T>
struct FieldType {
  using Element = T;
  static constexpr std::size_t kCount = 0;  // no array
};
template <typename T, std::size_t N>
struct FieldType<std::array<T, N>> {
  using Element = T;
  static constexpr std::size_t kCount = N;
};

struct FieldLayout {
  std::string_view name, type;
  std::size_t element_bytes = 0;
  std::size_t count = 0;  ///< of an array, else 0
  bool is_extension = false;
  std::size_t offset = 0;

  [[nodiscard]] constexpr std::size_t bytes() const {
    return element_bytes * std::max<std::size_t>(count, 1);
  }
};

/// Wire format of a message.
struct Layout {
  static constexpr std::size_t kMaxFields = 24;
  std::array<FieldLayout, kMaxFields> fields{};  ///< in the order of the definition
  std::size_t field_count = 0;
  std::size_t length = 0;       ///< with extensions
  std::size_t base_length = 0;  ///< without extensions: the payload of MAVLink 1
  std::uint8_t crc_extra = 0;
};

/// Visitor for `fields` of a message that collects its definition.
class LayoutBuilder {
 public:
  template <typename T>
  constexpr void operator()(std::string_view name, const T& /*value*/) {
    using Element = typename FieldType<T>::Element;
    layout_.fields[layout_.field_count++] = {.name = name,
                                             .type = type_name<Element>(),
                                             .element_bytes = sizeof(Element),
                                             .count = FieldType<T>::kCount,
                                             .is_extension = in_extensions_};
  }
  constexpr void extensions() { in_extensions_ = true; }

  /// Fields are sent by decreasing element size, extensions after them in the order of their
  /// definition. CRC_EXTRA is the folded checksum of the message's name, types and names in wire
  /// order, without extensions.
  [[nodiscard]] constexpr Layout layout(std::string_view message) {
    Checksum checksum;
    checksum.add(message);
    checksum.add(" ");
    for (const std::size_t bytes : {8U, 4U, 2U, 1U}) {
      for (FieldLayout& field : std::span(layout_.fields).first(layout_.field_count)) {
        if (field.is_extension || field.element_bytes != bytes) continue;
        place(field);
        for (const std::string_view text : {field.type, field.name}) {
          checksum.add(text);
          checksum.add(" ");
        }
        if (field.count > 0) checksum.add(static_cast<std::uint8_t>(field.count));
      }
    }
    layout_.base_length = layout_.length;
    for (FieldLayout& field : std::span(layout_.fields).first(layout_.field_count)) {
      if (field.is_extension) place(field);
    }
    layout_.crc_extra =
        static_cast<std::uint8_t>((checksum.value() & 0xff) ^ (checksum.value() >> 8));
    return layout_;
  }

 private:
  constexpr void place(FieldLayout& field) {
    field.offset = layout_.length;
    layout_.length += field.bytes();
  }

  Layout layout_;
  bool in_extensions_ = false;
};

/// A message lists its fields once, in the order of the MAVLink definition:
///
///     static constexpr std::uint32_t kId = 103;
///     static constexpr std::string_view kName = "VISION_SPEED_ESTIMATE";
///     static constexpr void fields(auto& self, auto&& field) {
///       field("usec", self.usec);
///       field.extensions();
///       field("reset_counter", self.reset_counter);
///     }
template <typename M>
concept Message = requires(M& message, LayoutBuilder& builder) {
  { M::kId } -> std::convertible_to<std::uint32_t>;
  { M::kName } -> std::convertible_to<std::string_view>;
  M::fields(message, builder);
};

template <Message M>
[[nodiscard]] constexpr Layout layout_of() {
  LayoutBuilder builder;
  const M message;
  M::fields(message, builder);
  return builder.layout(M::kName);
}

template <Message M>
inline constexpr Layout kLayout = layout_of<M>();

}  // namespace stillkite::mavlink
