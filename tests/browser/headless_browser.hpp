#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace stillkite {

/// Command of an installed Chromium; nullopt without one.
[[nodiscard]] std::optional<std::string> find_browser();

/// Serialized DOM of the page after its scripts have run. `scratch`: folder for the browser.
[[nodiscard]] std::string rendered(const std::string& browser, const std::filesystem::path& page,
                                   const std::filesystem::path& scratch);

}  // namespace stillkite
