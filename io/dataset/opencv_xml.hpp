#pragma once

#include <filesystem>

#include "io/config/config_node.hpp"

namespace stillkite {

/// True if the file's first character is '<'.
[[nodiscard]] bool is_xml(const std::filesystem::path& file);

/// OpenCV FileStorage in XML, as the same document in YAML; without line numbers. Throws InputError
/// on any other XML.
[[nodiscard]] ConfigNode read_opencv_xml(const std::filesystem::path& file);

}  // namespace stillkite
