#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

namespace stillkite {

// Telemetry lines of the Fotokite ground station (docs/live.md). Fields are separated by commas or
// blanks, lines by LF, CR or both.

/// !GSStatus mode,runtime,battery,relTetherLength
struct StationStatus {
  int mode = 0;
  double runtime_s = 0;
  double battery = 0;
  double relative_length_counts = 0;
};

/// !Attitude qw,qx,qy,qz
struct DroneAttitude {
  Eigen::Quaterniond world_from_body = Eigen::Quaterniond::Identity();
};

/// !Pos elevation,relAzimuth,baroAlt. The elevation is zero at the zenith and falls beyond it.
struct DronePosition {
  double elevation_from_zenith_rad = 0;
  double azimuth_rad = 0;
  double barometer_m = 0;
};

/// !FlightStatus mode,onTime,backup,flags
struct DroneStatus {
  int mode = 0;
  double on_time_s = 0;
  double backup = 0;
  std::uint32_t fault_flags = 0;
};

using StationMessage = std::variant<StationStatus, DroneAttitude, DronePosition, DroneStatus>;

/// Message of a line without its end; nullopt for other lines, missing or excess fields, values
/// that are no finite numbers or out of range, and quaternions without unit norm (5 %).
[[nodiscard]] std::optional<StationMessage> parse_station_line(std::string_view line);

/// Line with its end, as the ground station sends it.
[[nodiscard]] std::string station_line(const StationMessage& message);

}  // namespace stillkite
