#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace stillkite {

/// Indented. A name that is no UTF-8, as a file's may be, has its strange bytes replaced.
[[nodiscard]] inline std::string json_text(const nlohmann::json& json) {
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace stillkite
