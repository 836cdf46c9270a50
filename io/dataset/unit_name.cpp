#include "io/dataset/unit_name.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <utility>

namespace stillkite {
namespace {

// Canonical spelling: m s^-2, m·s⁻², M*S-2 become ms-2.
std::string canonical(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (std::string_view(" \t*^.").find(c) != std::string_view::npos) continue;
    out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  constexpr auto kReplacements =
      std::to_array<std::pair<std::string_view, std::string_view>>({{"\u00b2", "2"},
                                                                    {"\u207b", "-"},
                                                                    {"\u00b9", "1"},
                                                                    {"\u00b7", ""},
                                                                    {"\u00b5", "u"},
                                                                    {"\u03bc", "u"},
                                                                    {"\u00b0", "deg"}});
  for (const auto& [from, to] : kReplacements) {
    for (std::size_t at; (at = out.find(from)) != std::string::npos;) {
      out.replace(at, from.size(), to);
    }
  }
  return out;
}

constexpr auto kSpellings = std::to_array<std::pair<Unit, std::string_view>>(
    {{Unit::nanosecond, " ns nsec nanosecond nanoseconds "},
     {Unit::microsecond, " us usec microsecond microseconds "},
     {Unit::millisecond, " ms msec millisecond milliseconds "},
     {Unit::second, " s sec second seconds "},
     {Unit::metre, " m metre metres meter meters "},
     {Unit::metre_per_s, " m/s m/sec ms-1 "},
     {Unit::metre_per_s2, " m/s2 m/s/s m/sec2 ms-2 "},
     {Unit::radian_per_s, " rad/s rad/sec rads-1 "},
     {Unit::radian_per_s2, " rad/s2 rad/s/s rad/sec2 rads-2 "},
     {Unit::other, " min minutes h hours days "},
     {Unit::other,
      " um mm cm dm km ft feet foot in inch inches yd millimetre millimetres "
      "millimeter millimeters centimetre centimetres centimeter centimeters "
      "kilometre kilometres kilometer kilometers "},
     {Unit::other, " pa hpa kpa mbar millibar mmhg inhg psi atm pascal pascals "},
     {Unit::other, " mm/s mms-1 cm/s cms-1 km/h kmh kmh-1 ft/s kn kt knots mph "},
     {Unit::other, " g mg mm/s2 mms-2 cm/s2 cms-2 ft/s2 gal "},
     {Unit::other,
      " deg degree degrees deg/s deg/sec degs-1 degree/s degrees/s dps mdps mdeg/s "
      "mrad/s rpm rad deg/s2 degs-2 "}});

std::optional<Unit> parse_unit(std::string_view text) {
  const std::string wanted = ' ' + canonical(text) + ' ';
  for (const auto& [unit, spellings] : kSpellings) {
    if (spellings.find(wanted) != std::string_view::npos) return unit;
  }
  return std::nullopt;
}

// Unit suffix such as height_cm, wx_deg_s. Single letters are ambiguous and ignored.
std::optional<Unit> unit_after_underscore(std::string_view name) {
  for (std::size_t at; (at = name.find('_')) != std::string_view::npos;) {
    name.remove_prefix(at + 1);
    std::string ending(name);
    std::ranges::replace(ending, '_', '/');
    if (ending.size() < 2 || ending == "in") continue;
    if (const std::optional<Unit> unit = parse_unit(ending)) return unit;
  }
  return std::nullopt;
}

}  // namespace

std::string_view symbol_of(Unit unit) {
  constexpr std::array<std::string_view, 10> kSymbols{
      "ns", "us", "ms", "s", "m", "m/s", "m/s^2", "rad/s", "rad/s^2", "another unit"};
  return kSymbols.at(static_cast<std::size_t>(unit));
}

std::optional<Unit> unit_in_brackets(std::string_view column_name) {
  for (const char* brackets : {"[]", "()"}) {
    const std::size_t open = column_name.find(brackets[0]);
    const std::size_t close = column_name.find(brackets[1], open);
    if (open == std::string_view::npos || close == std::string_view::npos) continue;
    return parse_unit(column_name.substr(open + 1, close - open - 1));
  }
  return std::nullopt;
}

std::optional<Unit> unit_in(std::string_view column_name) {
  if (column_name.find_first_of("[(") != std::string_view::npos) {
    return unit_in_brackets(column_name);
  }
  return unit_after_underscore(column_name);
}

}  // namespace stillkite
