#pragma once

#include <filesystem>

#include "io/import/imported_flight.hpp"

namespace stillkite {

/// Sensors of a telemetry log of a ground station (tlog): MAVLink packets, each after the time of
/// its arrival. Packets of the system and component that first sends one of the messages are read;
/// of several messages of a quantity, the best. Clock: time since the autopilot's boot, in the
/// messages; RANGEFINDER has the last message's. Messages, units and frames: docs/import.md.
[[nodiscard]] ImportedFlight read_telemetry_log(const std::filesystem::path& file);

}  // namespace stillkite
