#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/import/byte_source.hpp"

namespace stillkite {

/// Layout of a DataFlash message, from its FMT message: a format character per field.
struct DataflashLayout {
  struct Field {
    std::string name;
    char type;
    std::size_t offset;
  };
  std::string name;
  std::size_t bytes = 0;  ///< with the three of the header; 0: no message of this number
  std::vector<Field> fields;

  /// Value in the unit of the format character: c, C, e, E are hundredths, L is 1e-7 deg. Nullopt
  /// without such a field or if it is text.
  [[nodiscard]] std::optional<double> number(Bytes message, std::string_view field) const;
  /// As above, 0 without such a field.
  [[nodiscard]] double number_or_zero(Bytes message, std::string_view field) const {
    return number(message, field).value_or(0);
  }

 private:
  [[nodiscard]] const Field* find(std::string_view field) const;
};

/// Layout described by a FMT message, with its number; nullopt if the format is malformed.
[[nodiscard]] std::optional<std::pair<std::uint8_t, DataflashLayout>> read_dataflash_layout(
    Bytes format_message);

}  // namespace stillkite
