#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/variants.hpp"
#include "simulation/hover/hover_trial.hpp"

namespace stillkite {

/// The plant of its own file first, then what the configuration and the command line say. Throws
/// InputError as load_run_config.
[[nodiscard]] HoverConfig load_hover_config(const std::optional<std::filesystem::path>& file,
                                            const std::vector<std::string>& overrides);

/// The scene and the video link's compression.
[[nodiscard]] HoverWorld make_world(const HoverConfig& config);

/// One of several configurations that fly the same trials in the same world.
using HoverVariant = VariantOf<HoverConfig>;

/// As load_variants: what is flown, the scene, the link and the plant are the same for all.
[[nodiscard]] std::vector<HoverVariant> load_hover_variants(
    const std::filesystem::path& file, const std::vector<std::string>& overrides,
    const std::vector<VariantName>& names);

}  // namespace stillkite
