#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/variants.hpp"
#include "io/config/config_node.hpp"
#include "simulation/hover/hover_trial.hpp"

namespace stillkite {

/// Effective configuration of trials: the plant file, overridden by the configuration and the
/// command line. Throws InputError as load_run_config.
[[nodiscard]] HoverConfig load_hover_config(const std::optional<std::filesystem::path>& file,
                                            const std::vector<std::string>& overrides);

/// Hover configuration of a document with its plant file.
[[nodiscard]] HoverConfig bind_hover_config(const ConfigNode& root);

/// Creates the scene and the video link's compression.
[[nodiscard]] HoverWorld make_world(const HoverConfig& config);

/// One of several configurations for the same trials and world.
using HoverVariant = VariantOf<HoverConfig>;

/// As load_variants; trials, scene, link and plant are the same for all.
[[nodiscard]] std::vector<HoverVariant> load_hover_variants(
    const std::filesystem::path& file, const std::vector<std::string>& overrides,
    const std::vector<VariantName>& names);

}  // namespace stillkite
