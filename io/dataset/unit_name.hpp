#pragma once

#include <optional>
#include <string_view>

namespace stillkite {

/// Units of table columns; `other`: a known unit that no table is read in.
enum class Unit {
  nanosecond,
  microsecond,
  millisecond,
  second,
  metre,
  metre_per_s,
  metre_per_s2,
  radian_per_s,
  radian_per_s2,
  other
};

/// Symbol for messages: "m/s^2".
[[nodiscard]] std::string_view symbol_of(Unit unit);

/// Unit in a column name: `height [m]`, `height (m)`, `height_cm`, in the common spellings. Nullopt
/// without a known unit.
[[nodiscard]] std::optional<Unit> unit_in(std::string_view column_name);

/// Unit in the brackets of a column name; nullopt without brackets or known unit.
[[nodiscard]] std::optional<Unit> unit_in_brackets(std::string_view column_name);

}  // namespace stillkite
