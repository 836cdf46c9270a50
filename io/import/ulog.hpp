#pragma once

#include <filesystem>

#include "io/import/imported_flight.hpp"

namespace stillkite {

/// Sensors of a PX4 log (ULog, docs.px4.io/main/en/dev_log/ulog_file_format.html), first instance
/// of each topic. Clock: microseconds since the autopilot's boot, of the sample where recorded.
/// Topics, units and frames: docs/import.md.
[[nodiscard]] ImportedFlight read_ulog(const std::filesystem::path& file);

}  // namespace stillkite
