#pragma once

#include <array>
#include <concepts>
#include <type_traits>
#include <utility>

#include "io/config/config_values.hpp"

namespace stillkite {

/// Config struct with a static `fields` (geometry/fields.hpp).
template <typename T>
concept ListsFields = requires(T& self) {
  T::fields(self, [](auto&&...) {});
};

template <typename T>
inline constexpr bool kIsOptional = false;
template <typename T>
inline constexpr bool kIsOptional<std::optional<T>> = true;
template <typename T>
inline constexpr bool kIsNumberArray = false;
template <std::size_t N>
inline constexpr bool kIsNumberArray<std::array<double, N>> = true;

template <typename Enum>
[[nodiscard]] constexpr auto enum_names() {
  std::array<std::string_view, EnumNames<Enum>::value.size()> names;
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = EnumNames<Enum>::value[i].second;
  return names;
}

/// Reads the keys of a map into the fields of a struct. Absent keys keep their values.
/// Throws InputError on an unknown key, a value of the wrong kind, and a value out of range.
template <ListsFields Config>
void read_fields(const ConfigNode& map, const std::string& prefix, Config& config);

/// Reads one value. Null resets an optional and is an error for any other type but ConfigNode,
/// which receives the YAML value itself.
template <typename T>
void read_value(const ConfigNode& node, const std::string& key, const Range& range, T& value) {
  if constexpr (kIsOptional<T>) {
    if (node.kind == ConfigNode::Kind::null) return value.reset();
    typename T::value_type inner = value.value_or(typename T::value_type{});
    read_value(node, key, range, inner);
    value = std::move(inner);
  } else if constexpr (std::same_as<T, ConfigNode>) {
    value = node;
  } else if constexpr (std::same_as<T, bool>) {
    value = read_flag(node, key);
  } else if constexpr (std::integral<T>) {
    constexpr auto kMax = static_cast<double>(std::numeric_limits<T>::max());
    constexpr auto kMin = static_cast<double>(std::numeric_limits<T>::lowest());
    const bool tighter = range.min >= kMin;
    value = static_cast<T>(read_integer(node, key,
                                        {.min = tighter ? range.min : kMin,
                                         .max = std::min(range.max, kMax),
                                         .open_min = tighter && range.open_min}));
  } else if constexpr (std::floating_point<T>) {
    value = static_cast<T>(read_number(node, key, range));
  } else if constexpr (std::same_as<T, std::string>) {
    value = read_string(node, key);
  } else if constexpr (std::same_as<T, std::filesystem::path>) {
    value = read_path(node, key);
  } else if constexpr (std::is_enum_v<T>) {
    value = EnumNames<T>::value[read_choice(node, key, enum_names<T>())].first;
  } else if constexpr (std::same_as<T, std::vector<double>>) {
    value = read_numbers(node, key, range);
  } else if constexpr (kIsNumberArray<T>) {
    const std::vector<double> numbers = read_numbers(node, key, range, value.size());
    std::copy(numbers.begin(), numbers.end(), value.begin());
  } else {
    read_fields(node, key + ".", value);
  }
}

/// Visitor for `Config::fields` that reads values.
class FieldReader {
 public:
  FieldReader(const ConfigNode& map, const std::string& prefix) : map_(map), prefix_(prefix) {}

  template <typename T>
  void operator()(std::string_view name, T& value, const Range& range, std::string_view) {
    const ConfigNode* node = map_.find(name);
    if (node != nullptr) read_value(*node, prefix_ + std::string(name), range, value);
  }
  template <typename T>
  void operator()(std::string_view name, T& value, std::string_view help) {
    (*this)(name, value, kAny, help);
  }

 private:
  const ConfigNode& map_;
  const std::string& prefix_;
};

template <ListsFields Config>
[[nodiscard]] std::vector<std::string_view> field_names(const Config& config) {
  std::vector<std::string_view> names;
  Config::fields(config, [&](std::string_view name, auto&&...) { names.push_back(name); });
  return names;
}

template <ListsFields Config>
void read_fields(const ConfigNode& map, const std::string& prefix, Config& config) {
  reject_unknown_keys(map, prefix, field_names(config));
  Config::fields(config, FieldReader(map, prefix));
}

/// Defaults overridden by the document.
template <ListsFields Config>
[[nodiscard]] Config bind_config(const ConfigNode& root, Config defaults = {}) {
  read_fields(root, "", defaults);
  return defaults;
}

}  // namespace stillkite
