#pragma once

#include <optional>
#include <string_view>

namespace stillkite {

/// What tables are read in, and all that surely is none of these.
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

/// As messages write it.
[[nodiscard]] std::string_view symbol_of(Unit unit);

/// The unit that a column's name gives: `height [m]`, `height (m)`, `height_cm`, in whatever
/// spelling. Nothing where it gives none, or none that is known.
[[nodiscard]] std::optional<Unit> unit_in(std::string_view column_name);

/// The same, by brackets alone.
[[nodiscard]] std::optional<Unit> unit_in_brackets(std::string_view column_name);

}  // namespace stillkite
