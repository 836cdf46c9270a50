#pragma once

#include <filesystem>

#include "io/import/imported_flight.hpp"

namespace stillkite {

/// Sensors of an ArduPilot log (DataFlash .bin), first instance of each sensor. The file describes
/// its own messages. Clock: time since the autopilot's boot. Messages, units and frames:
/// docs/import.md.
[[nodiscard]] ImportedFlight read_dataflash(const std::filesystem::path& file);

}  // namespace stillkite
