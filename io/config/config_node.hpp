#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stillkite {

/// One value of a YAML document and where it was written, so that a message can point at it.
struct ConfigNode {
  enum class Kind { null, scalar, list, map };

  Kind kind = Kind::null;
  std::string text{};               ///< of a scalar
  bool quoted = false;              ///< a quoted scalar is text even if it looks like a number
  std::vector<ConfigNode> items{};  ///< of a list
  std::vector<std::pair<std::string, ConfigNode>> entries{};  ///< of a map, in the file's order

  std::string origin{};                 ///< file, or the command line's "--set key=value"
  std::filesystem::path base_folder{};  ///< where relative paths written here count from
  int line = 0;                         ///< of the key (of the value in a list), from 1; 0 unknown
  int column = 0;

  /// "file:line:column", or the origin alone.
  [[nodiscard]] std::string where() const;

  /// The value under the key; nullptr if this is no map or has no such key.
  [[nodiscard]] const ConfigNode* find(std::string_view key) const;
};

/// Throws InputError "file:line:column: ..." on what is not YAML, on repeated keys, and on
/// documents too large or too deep to be a configuration. A first line `%YAML:1.0` is accepted.
[[nodiscard]] ConfigNode parse_yaml(const std::string& text, const std::string& origin,
                                    const std::filesystem::path& base_folder);

/// Throws InputError also where the file cannot be read or is empty.
[[nodiscard]] ConfigNode read_yaml(const std::filesystem::path& file);

/// Lays `key.path=value` of the command line over the document. The value is read as YAML where it
/// begins with [ or {, else it is one scalar. Relative paths in it count from the current folder.
void apply_override(ConfigNode& root, const std::string& assignment);

/// A configuration file under the command line's key=value's; without a file these alone.
[[nodiscard]] ConfigNode read_config(const std::optional<std::filesystem::path>& file,
                                     const std::vector<std::string>& overrides);

}  // namespace stillkite
