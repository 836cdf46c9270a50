#pragma once

#include <filesystem>
#include <string>

#include "simulation/simulate.hpp"

namespace stillkite {

// The texts of a simulated flight's files. World, body and camera as in docs/notation.md; stamps
// count from the first frame.

/// EuRoC's sensor.yaml of the camera; T_BS is body_from_camera.
[[nodiscard]] std::string camera_yaml(const FlightRecord& flight, double frames_per_s);

/// state_groundtruth_estimate0/data.csv: pose, velocity in the world, biases of the IMU left out.
[[nodiscard]] std::string truth_csv(const FlightRecord& flight);
[[nodiscard]] std::string truth_tum(const FlightRecord& flight);

/// velocity.csv: a row is the motion half way between the frame before and this one, in the camera.
[[nodiscard]] std::string velocity_csv(const FlightRecord& flight);

[[nodiscard]] std::string imu_csv(const FlightRecord& flight);
[[nodiscard]] std::string range_csv(const FlightRecord& flight);

/// Writes what both layouts share below the data set's folder: sensor.yaml of the camera into
/// `camera_folder`, the truth and the IMU as EuRoC has them, and at the top what EuRoC has not.
void write_flight_files(const FlightRecord& flight, double frames_per_s,
                        const std::filesystem::path& top, const std::filesystem::path& dataset,
                        const std::filesystem::path& camera_folder);

}  // namespace stillkite
