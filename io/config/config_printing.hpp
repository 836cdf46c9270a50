#pragma once

#include <fmt/format.h>

#include "io/config/config_binding.hpp"

namespace stillkite {

/// Visitor for `Config::fields` that prints one line per key; the comment holds description, range
/// and enum names.
class FieldPrinter {
 public:
  FieldPrinter(std::string& out, std::string indent) : out_(out), indent_(std::move(indent)) {}

  template <typename T>
  void operator()(std::string_view name, const T& value, const Range& range,
                  std::string_view help) {
    if constexpr (ListsFields<T>) {
      out_ += fmt::format("{}{}:  # {}\n", indent_, name, help);
      T::fields(value, FieldPrinter(out_, indent_ + "  "));
    } else if constexpr (kIsOptional<T>) {
      if (value.has_value()) return (*this)(name, *value, range, help);
      using Inner = typename T::value_type;
      out_ += fmt::format("{}{}: null  # {}{}\n", indent_, name, help, limits<Inner>(range));
      // template of the absent group, commented out
      if constexpr (ListsFields<Inner>) {
        const Inner pattern;
        Inner::fields(pattern, FieldPrinter(out_, indent_ + "#  "));
      }
    } else {
      out_ +=
          fmt::format("{}{}: {}  # {}{}\n", indent_, name, print(value), help, limits<T>(range));
    }
  }
  template <typename T>
  void operator()(std::string_view name, const T& value, std::string_view help) {
    (*this)(name, value, kAny, help);
  }

 private:
  template <typename T>
  static std::string print(const T& value) {
    if constexpr (std::same_as<T, bool>)
      return value ? "true" : "false";
    else if constexpr (std::integral<T>)
      return fmt::format("{}", value);
    else if constexpr (std::floating_point<T>)
      return print_number(value);
    else if constexpr (std::is_enum_v<T>)
      return print_text(name_of(value));
    else if constexpr (std::is_convertible_v<T, std::string>)
      return print_text(std::string(value));
    else
      return fmt::format("[{}]", fmt::join(value, ", "));
  }

  template <typename T>
  static std::string limits(const Range& range) {
    if constexpr (std::is_enum_v<T>) return fmt::format(": {}", fmt::join(enum_names<T>(), " | "));
    const std::string text = print_range(range);
    return text.empty() ? text : "; in " + text;
  }

  std::string& out_;
  std::string indent_;
};

/// Configuration as YAML; parsing it returns the same values.
template <ListsFields Config>
[[nodiscard]] std::string print_config(const Config& config) {
  std::string out;
  Config::fields(config, FieldPrinter(out, ""));
  return out;
}

}  // namespace stillkite
