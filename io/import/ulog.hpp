#pragma once

#include <filesystem>

#include "io/import/imported_flight.hpp"

namespace stillkite {

/// Sensors of a PX4 log (ULog, docs.px4.io/main/en/dev_log/ulog_file_format.html), first instance
/// of each topic. Clock: microseconds since the autopilot's boot, of the sample where recorded.
///
/// | topic | fields | unit, frame |
/// |---|---|---|
/// | sensor_combined | gyro_rad, accelerometer_m_s2 | rad/s, m/s^2, FRD |
/// | vehicle_attitude | q | ned_from_frd, w x y z |
/// | vehicle_gps_position, sensor_gps | position, velocity | 1e-7 deg or deg, mm or m; m/s, NED |
/// | vehicle_air_data | baro_alt_meter | m |
/// | distance_sensor, facing down | current_distance | m |
///
/// Throws InputError "file: problem" without a readable message.
[[nodiscard]] ImportedFlight read_ulog(const std::filesystem::path& file);

}  // namespace stillkite
