#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace stillkite {

/// Name of an installed Chromium; nothing without one.
[[nodiscard]] std::optional<std::string> find_browser();

/// The page as it stands once its scripts have run, serialised. `scratch` is the browser's own.
[[nodiscard]] std::string rendered(const std::string& browser, const std::filesystem::path& page,
                                   const std::filesystem::path& scratch);

}  // namespace stillkite
