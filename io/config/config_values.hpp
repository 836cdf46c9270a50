#pragma once

#include <Eigen/Geometry>
#include <array>
#include <filesystem>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/fields.hpp"
#include "io/config/config_node.hpp"

namespace stillkite {

// Readers and printers of single configuration values. `key` is the full dotted path. Every reader
// throws InputError "file:line:column: key: problem".

[[noreturn]] void reject_value(const ConfigNode& node, const std::string& key,
                               const std::string& problem);

[[nodiscard]] bool read_flag(const ConfigNode& node, const std::string& key);
[[nodiscard]] long long read_integer(const ConfigNode& node, const std::string& key,
                                     const Range& range);
[[nodiscard]] double read_number(const ConfigNode& node, const std::string& key,
                                 const Range& range);
[[nodiscard]] std::string read_string(const ConfigNode& node, const std::string& key);
[[nodiscard]] std::filesystem::path read_path(const ConfigNode& node, const std::string& key);

/// List of any length, or of exactly `size` numbers.
inline constexpr std::size_t kAnySize = std::numeric_limits<std::size_t>::max();
[[nodiscard]] std::vector<double> read_numbers(const ConfigNode& node, const std::string& key,
                                               const Range& range, std::size_t size = kAnySize);

/// Unit quaternion of a configured rotation. Throws InputError unless its norm is 1 within 1 %.
[[nodiscard]] Eigen::Quaterniond unit_quaternion(const std::array<double, 4>& wxyz,
                                                 const std::string& key);

/// Index of the scalar in `names`.
[[nodiscard]] std::size_t read_choice(const ConfigNode& node, const std::string& key,
                                      std::span<const std::string_view> names);

/// Throws InputError if the map has a key that is not in `known`; suggests the nearest one.
void reject_unknown_keys(const ConfigNode& map, const std::string& prefix,
                         std::span<const std::string_view> known);

/// Name with the smallest edit distance to `word`; empty if none is closer than a third of it.
[[nodiscard]] std::string_view nearest_name(std::string_view word,
                                            std::span<const std::string_view> known);

/// Shortest text that parses to the same number.
[[nodiscard]] std::string print_number(double value);

/// Text as a YAML scalar, quoted if required.
[[nodiscard]] std::string print_text(std::string_view text);

/// "[0, 1]", "(0, inf)"; empty for an unbounded range.
[[nodiscard]] std::string print_range(const Range& range);

}  // namespace stillkite
