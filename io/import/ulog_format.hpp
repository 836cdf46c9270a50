#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/import/byte_source.hpp"

namespace stillkite {

enum class UlogType { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

/// Field of a message: `count` values of `type` at byte `offset`.
struct UlogField {
  UlogType type;
  std::size_t offset;
  std::size_t count;
};

/// Numeric fields of a message that are not in a nested type, by name.
struct UlogLayout {
  std::map<std::string, UlogField, std::less<>> fields;

  /// Value `index` of a field; nullopt if the field or the bytes are missing.
  [[nodiscard]] std::optional<double> number(Bytes message, std::string_view name,
                                             std::size_t index = 0) const;
  /// Unsigned 64-bit field, such as a stamp.
  [[nodiscard]] std::optional<std::uint64_t> integer(Bytes message, std::string_view name) const;
};

/// Message definitions of a log, "name:type field;type[n] field;".
class UlogFormats {
 public:
  /// Returns false if the definition is malformed.
  bool add(std::string_view definition);

  /// Nullopt if the type or a nested one is not defined, or nested more than eight deep.
  [[nodiscard]] std::optional<UlogLayout> layout(std::string_view name) const;

 private:
  struct Member {
    std::string type;
    std::string name;
    std::size_t count;
  };
  [[nodiscard]] std::optional<std::size_t> size_of(std::string_view type, int depth) const;

  std::map<std::string, std::vector<Member>, std::less<>> members_;
};

}  // namespace stillkite
