#pragma once

#include <filesystem>

#include "io/import/imported_flight.hpp"

namespace stillkite {

/// Sensors of an ArduPilot log (DataFlash .bin), first instance of each sensor. The file describes
/// its own messages. Clock: microseconds since the autopilot's boot.
///
/// | message | fields | unit, frame |
/// |---|---|---|
/// | IMU | GyrX GyrY GyrZ, AccX AccY AccZ | rad/s, m/s^2, FRD |
/// | ATT | Roll, Pitch, Yaw | deg, frd relative to NED |
/// | GPS | Lat, Lng, Alt; Spd, GCrs, VZ | deg, m; m/s, course in deg, down |
/// | BARO | Alt | m |
/// | RFND, facing down | Dist or Dist1 | m |
[[nodiscard]] ImportedFlight read_dataflash(const std::filesystem::path& file);

}  // namespace stillkite
