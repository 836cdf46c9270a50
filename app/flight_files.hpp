#pragma once

#include <filesystem>

#include "simulation/flight/simulate.hpp"

namespace stillkite {

/// Writes the files common to both layouts: the camera's sensor.yaml into `camera_folder`, truth
/// and IMU in EuRoC's format into `dataset`, all other logs into `top`. Frames as in
/// docs/notation.md; stamps are relative to the first frame.
void write_flight_files(const FlightRecord& flight, double frames_per_s,
                        const std::filesystem::path& top, const std::filesystem::path& dataset,
                        const std::filesystem::path& camera_folder);

}  // namespace stillkite
