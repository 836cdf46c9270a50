#pragma once

#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace stillkite {

/// Allowed values of a number in a config, bounds included.
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool open_min = false;  // min itself is not allowed

  [[nodiscard]] constexpr bool contains(double x) const {
    return (open_min ? x > min : x >= min) && x <= max;
  }
};

inline constexpr Range kAny{};
inline constexpr Range kPositive{.min = 0.0, .open_min = true};
inline constexpr Range kNotNegative{.min = 0.0};
inline constexpr Range kAnySeed{.min = 0, .max = std::numeric_limits<int>::max()};

/// A config struct lists its fields once, in a static member template
///
///     static void fields(auto& self, auto&& field) {
///       field("window_px", self.window_px, Range{3, 99}, "side of the Lucas-Kanade window");
///       field("camera", self.camera, "the lens");           // a nested struct, text, flag or enum
///     }
///
/// from which files are read, rejected and printed. Types: bool, int, double, std::string, an enum
/// with EnumNames, std::vector<double>, std::optional of these, and structs that list their fields.
///
/// Names of an enum's values: an array of pairs (value, name).
template <typename Enum>
struct EnumNames;

template <typename Enum>
[[nodiscard]] constexpr std::string_view name_of(Enum wanted) {
  for (const auto& [value, name] : EnumNames<Enum>::value) {
    if (value == wanted) return name;
  }
  return "?";
}

/// What a user can mend: a wrong file, key or value. The message names all three and the remedy.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace stillkite
