#include "io/config/renamed_keys.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <optional>

#include "geometry/fields.hpp"

namespace stillkite {
namespace {

struct RenamedKey {
  std::string_view before;
  std::string_view now;
};

// Accepted until version 0.3.
constexpr auto kRenamedKeys = std::to_array<RenamedKey>({
    {"choice.way_sigma_ratio", "choice.translation_sigma_ratio"},
    {"hold.forget_after_s", "hold.reset_integral_after_s"},
    {"plant.fault.stamps_off_s", "plant.fault.stamp_offset_s"},
    {"plant.passers", "plant.moving_objects"},
    {"plant.station.upright_reach_m", "plant.station.vertical_reach_m"},
    {"reference.gate.strikes", "reference.gate.max_consecutive_rejections"},
    {"reference.seek_home_every_frames", "reference.relocalize_every_frames"},
});

struct RemovedKey {
  std::string_view key;
  std::string_view value;  ///< constant in the code, or former default
  std::string_view now;    ///< key to use instead; empty: none
};

// Accepted with this value until version 0.3: a printed configuration lists every key.
constexpr auto kRemovedKeys = std::to_array<RemovedKey>({
    {"navigator.levelling.flow_sigma_rad", "1e-05", "navigator.lens_sigma_px"},
    {"navigator.paper.least_squares.max_iterations", "15", ""},
    {"reference.pose.max_iterations", "2000", ""},
    {"reference.pose.min_pairs", "12", ""},
    {"reference.pose.refine", "true", ""},
    {"reference.pose.use_prior", "true", ""},
    {"reference.windows.warm_start", "true", ""},
});

ConfigNode* find_entry(ConfigNode& map, std::string_view key) {
  const auto at = std::ranges::find(map.entries, key, &std::pair<std::string, ConfigNode>::first);
  return at == map.entries.end() ? nullptr : &at->second;
}

// Removes and returns the value at a path; empty maps on the path stay.
std::optional<ConfigNode> take_value(ConfigNode& root, std::string_view path) {
  ConfigNode* map = &root;
  for (std::size_t dot = path.find('.'); dot != std::string_view::npos; dot = path.find('.')) {
    map = find_entry(*map, path.substr(0, dot));
    if (map == nullptr) return std::nullopt;
    path.remove_prefix(dot + 1);
  }
  ConfigNode* const value = find_entry(*map, path);
  if (value == nullptr) return std::nullopt;
  ConfigNode taken = std::move(*value);
  std::erase_if(map->entries, [&](const auto& entry) { return entry.first == path; });
  return taken;
}

// The node at a path, created with its maps where it is missing.
ConfigNode& value_at(ConfigNode& root, std::string_view path) {
  ConfigNode* at = &root;
  while (!path.empty()) {
    at->kind = ConfigNode::Kind::map;
    const std::string_view key = path.substr(0, path.find('.'));
    path.remove_prefix(std::min(path.size(), key.size() + 1));
    if (find_entry(*at, key) == nullptr) at->entries.emplace_back(key, ConfigNode{});
    at = find_entry(*at, key);
  }
  return *at;
}

}  // namespace

std::vector<std::string> move_renamed_keys(ConfigNode& root, std::string_view prefix,
                                           bool replaces) {
  std::vector<std::string> notices;
  for (const RenamedKey& key : kRenamedKeys) {
    if (!key.before.starts_with(prefix) || !key.now.starts_with(prefix)) continue;
    std::optional<ConfigNode> value = take_value(root, key.before.substr(prefix.size()));
    if (!value) continue;
    notices.push_back(fmt::format("{}: key '{}' is now '{}'", value->where(), key.before, key.now));
    ConfigNode& target = value_at(root, key.now.substr(prefix.size()));
    if (!replaces && target.kind != ConfigNode::Kind::null) {
      throw InputError(notices.back() + "; both are given: keep the new one");
    }
    target = std::move(*value);
  }
  return notices;
}

std::vector<std::string> drop_removed_keys(ConfigNode& root, std::string_view prefix) {
  std::vector<std::string> notices;
  for (const RemovedKey& removed : kRemovedKeys) {
    if (!removed.key.starts_with(prefix)) continue;
    const std::optional<ConfigNode> value = take_value(root, removed.key.substr(prefix.size()));
    if (!value) continue;
    const std::string reason = removed.now.empty()
                                   ? fmt::format("its value is always {}", removed.value)
                                   : fmt::format("use {}", removed.now);
    notices.push_back(
        fmt::format("{}: key '{}' was removed; {}", value->where(), removed.key, reason));
    if (value->text != removed.value) throw InputError(notices.back() + "; remove the key");
  }
  return notices;
}

}  // namespace stillkite
