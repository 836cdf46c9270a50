#pragma once

#include <filesystem>

#include "io/import/imported_flight.hpp"

namespace stillkite {

/// Sensors of a telemetry log of a ground station (tlog): MAVLink packets, each after the time of
/// its arrival. Packets of the vehicle that first sends one of these messages are read. Clock: time
/// since the autopilot's boot, in the messages; RANGEFINDER has the last message's.
///
/// | message | fields | unit, frame |
/// |---|---|---|
/// | HIGHRES_IMU, else SCALED_IMU, else RAW_IMU | gyroscope, accelerometer | FRD; rad/s and m/s^2,
/// mrad/s and 9.80665e-3 m/s^2 | | ATTITUDE_QUATERNION, else ATTITUDE | q; roll, pitch, yaw |
/// ned_from_frd; rad | | GPS_RAW_INT with a fix | lat, lon, alt | 1e-7 deg, mm | |
/// GLOBAL_POSITION_INT | vx, vy, vz | cm/s, NED: the autopilot's estimate | | SCALED_PRESSURE |
/// press_abs | hPa, to height in the standard atmosphere | | DISTANCE_SENSOR facing down, else
/// RANGEFINDER | distance | cm, m |
[[nodiscard]] ImportedFlight read_telemetry_log(const std::filesystem::path& file);

}  // namespace stillkite
