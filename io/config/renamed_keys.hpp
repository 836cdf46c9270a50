#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "io/config/config_node.hpp"

namespace stillkite {

/// Moves each key that has been renamed in this version to its new name. Returns one notice per
/// moved key, "file:line:column: key 'old' is now 'new'". `prefix`: path of `root` in the whole
/// configuration, "plant." for a plant file. Where both names are given the old one's value
/// replaces the new one's if `replaces`, else InputError is thrown.
[[nodiscard]] std::vector<std::string> move_renamed_keys(ConfigNode& root, std::string_view prefix,
                                                         bool replaces);

/// Drops each key that has been removed in this version. Returns one notice per dropped key. Throws
/// InputError if its value is not the one that is now constant. `prefix` as above.
[[nodiscard]] std::vector<std::string> drop_removed_keys(ConfigNode& root, std::string_view prefix);

}  // namespace stillkite
