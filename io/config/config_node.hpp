#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stillkite {

/// YAML value with its location, for error messages.
struct ConfigNode {
  enum class Kind { null, scalar, list, map };

  Kind kind = Kind::null;
  std::string text{};               ///< scalar only
  bool quoted = false;              ///< a quoted scalar is text, never a number
  std::vector<ConfigNode> items{};  ///< list only
  std::vector<std::pair<std::string, ConfigNode>> entries{};  ///< map only, in file order

  std::string origin{};                 ///< file, or "--set key=value" of the command line
  std::filesystem::path base_folder{};  ///< base of relative paths
  int line = 0;  ///< of the key (of the value in a list), from 1; 0 if unknown
  int column = 0;

  /// "file:line:column", or the origin if the line is unknown.
  [[nodiscard]] std::string where() const;

  /// Value of the key; nullptr if absent or if this is not a map.
  [[nodiscard]] const ConfigNode* find(std::string_view key) const;
};

/// Parses one YAML document. A first line `%YAML:1.0` (OpenCV) is accepted. Throws InputError
/// "file:line:column: ..." on invalid YAML, duplicate keys, and excessive size or depth.
[[nodiscard]] ConfigNode parse_yaml(const std::string& text, const std::string& origin,
                                    const std::filesystem::path& base_folder);

/// Parses a file. Also throws InputError if it is unreadable, empty or binary.
[[nodiscard]] ConfigNode read_yaml(const std::filesystem::path& file);

/// Sets `key.path=value` in the document. The value is YAML if it begins with [ or {, else a
/// scalar. Relative paths in it are relative to the current folder. Prints a notice for a key that
/// has been renamed (io/config/renamed_keys.hpp). Throws InputError without `=` or key.
void apply_override(ConfigNode& root, const std::string& assignment);

/// Sets each value of a group of keys in the document, as apply_override does: a key is a dotted
/// path or a group of keys. Relative paths are relative to the file of `settings`.
void apply_settings(ConfigNode& root, const ConfigNode& settings);

/// Configuration file with overrides `key.path=value`; without a file, the overrides alone. Prints
/// a notice for each key that has been renamed or removed (io/config/renamed_keys.hpp).
[[nodiscard]] ConfigNode read_config(const std::optional<std::filesystem::path>& file,
                                     const std::vector<std::string>& overrides);

/// File with one section of a configuration, such as a plant file (`prefix` "plant.").
[[nodiscard]] ConfigNode read_config_section(const std::filesystem::path& file,
                                             std::string_view prefix);

}  // namespace stillkite
