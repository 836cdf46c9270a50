#pragma once

#include <span>
#include <string>
#include <vector>

#include "io/config/run_config.hpp"
#include "navigation/inertial_finding.hpp"

namespace stillkite {

/// One message per finding: what differs, by how much, and the key to set.
[[nodiscard]] std::vector<std::string> inertial_messages(std::span<const InertialFinding> findings,
                                                         const RunConfig& config);

}  // namespace stillkite
