#pragma once

#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace stillkite {

/// Allowed range of a config value, bounds included.
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool open_min = false;  // excludes min

  [[nodiscard]] constexpr bool contains(double x) const {
    return (open_min ? x > min : x >= min) && x <= max;
  }
};

inline constexpr Range kAny{};
inline constexpr Range kPositive{.min = 0.0, .open_min = true};
inline constexpr Range kNonNegative{.min = 0.0};
inline constexpr Range kAnySeed{.min = 0, .max = std::numeric_limits<int>::max()};

/// A config struct lists its fields once, in a static member template:
///
///     static void fields(auto& self, auto&& field) {
///       field("window_px", self.window_px, Range{3, 99}, "side of the Lucas-Kanade window");
///       field("camera", self.camera, "camera model");       // nested struct, text, flag or enum
///     }
///
/// The list defines how files are read, validated and printed. Types: bool, int, double,
/// std::string, enums with EnumNames, std::vector<double>, std::optional of these, and structs with
/// `fields`.
///
/// EnumNames: array of pairs (value, name) of an enum.
template <typename Enum>
struct EnumNames;

template <typename Enum>
[[nodiscard]] constexpr std::string_view name_of(Enum enumerator) {
  for (const auto& [value, name] : EnumNames<Enum>::value) {
    if (value == enumerator) return name;
  }
  return "?";
}

/// User error in a file, key or value. The message states all three and the remedy.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace stillkite
