#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

namespace stillkite {

/// Blanks and commas separate the fields of a ground station's line.
inline constexpr std::string_view kFieldSeparators = ", \t";

/// The N finite numbers of a text; nullopt for fewer, more, or other fields.
template <std::size_t N>
[[nodiscard]] std::optional<std::array<double, N>> number_fields(std::string_view text) {
  std::array<double, N> out{};
  std::size_t count = 0;
  while (true) {
    const std::size_t begin = text.find_first_not_of(kFieldSeparators);
    if (begin == std::string_view::npos) break;
    if (count == N) return std::nullopt;
    text.remove_prefix(begin);
    const std::string_view cell = text.substr(0, text.find_first_of(kFieldSeparators));
    const auto result = std::from_chars(cell.data(), cell.data() + cell.size(), out[count]);
    const bool is_number = result.ec == std::errc() && result.ptr == cell.data() + cell.size();
    if (!is_number || !std::isfinite(out[count])) return std::nullopt;
    ++count;
    text.remove_prefix(cell.size());
  }
  return count == N ? std::optional(out) : std::nullopt;
}

}  // namespace stillkite
