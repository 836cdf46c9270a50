#pragma once

#include <filesystem>

#include "simulation/flight/simulate.hpp"

namespace stillkite {

/// Writes what both layouts share below the data set's folder: sensor.yaml of the camera into
/// `camera_folder`, the truth and the IMU as EuRoC has them, and at the top what EuRoC has not.
/// World, body and camera as in docs/notation.md; stamps count from the first frame.
void write_flight_files(const FlightRecord& flight, double frames_per_s,
                        const std::filesystem::path& top, const std::filesystem::path& dataset,
                        const std::filesystem::path& camera_folder);

}  // namespace stillkite
