#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace stillkite {

/// Indented JSON; bytes that are not UTF-8, such as in file names, are replaced.
[[nodiscard]] inline std::string json_text(const nlohmann::json& value) {
  return value.dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace stillkite
