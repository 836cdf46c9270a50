#pragma once

#include <filesystem>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/fields.hpp"
#include "io/config/config_node.hpp"

namespace stillkite {

// Single values of a configuration, read and printed. `key` is the full dotted path, for messages;
// every reader throws InputError "where: key: problem".

[[noreturn]] void reject_value(const ConfigNode& node, const std::string& key,
                               const std::string& problem);

[[nodiscard]] bool read_flag(const ConfigNode& node, const std::string& key);
[[nodiscard]] long long read_integer(const ConfigNode& node, const std::string& key,
                                     const Range& range);
[[nodiscard]] double read_number(const ConfigNode& node, const std::string& key,
                                 const Range& range);
[[nodiscard]] std::string read_string(const ConfigNode& node, const std::string& key);
[[nodiscard]] std::filesystem::path read_path(const ConfigNode& node, const std::string& key);

/// Any number of them, or exactly `size`.
inline constexpr std::size_t kAnySize = std::numeric_limits<std::size_t>::max();
[[nodiscard]] std::vector<double> read_numbers(const ConfigNode& node, const std::string& key,
                                               const Range& range, std::size_t size = kAnySize);

/// Index of the scalar among the names.
[[nodiscard]] std::size_t read_choice(const ConfigNode& node, const std::string& key,
                                      std::span<const std::string_view> names);

/// Throws if the map has a key that is not known; names the nearest known one.
void reject_unknown_keys(const ConfigNode& map, const std::string& prefix,
                         std::span<const std::string_view> known);

/// The name among `known` that `word` was probably meant to be; empty if none is near.
[[nodiscard]] std::string_view nearest_name(std::string_view word,
                                            std::span<const std::string_view> known);

/// Shortest text that reads back as the same number.
[[nodiscard]] std::string print_number(double value);

/// The text as YAML, quoted where it must be.
[[nodiscard]] std::string print_text(std::string_view text);

/// "[0, 1]", "(0, inf)", or nothing for any number.
[[nodiscard]] std::string print_range(const Range& range);

}  // namespace stillkite
