#pragma once

#include <pybind11/pybind11.h>

#include <optional>
#include <string>
#include <vector>

#include "io/config/config_node.hpp"
#include "io/config/run_config.hpp"

namespace stillkite::python {

/// Document of a configuration: None (no keys), YAML text, dict, or path of a YAML file; then the
/// overrides `key.path=value`. Throws InputError as read_config; TypeError for other types.
[[nodiscard]] ConfigNode document_of(const pybind11::object& source,
                                     const std::vector<std::string>& overrides);

/// Config, or what Config takes.
[[nodiscard]] RunConfig run_config_of(const pybind11::object& source);

}  // namespace stillkite::python
