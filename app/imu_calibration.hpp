#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "app/calibrate_config.hpp"

namespace stillkite {

/// Rotation and clock between camera and IMU, by the rotations of a flight. Writes imu.yaml (keys
/// of a run) and calibration.json to the folder, both or none, and returns calibration.json. Throws
/// InputError if images and IMU do not determine them.
nlohmann::json calibrate_imu(const RunConfig& config, const std::filesystem::path& out);

/// Values on standard output.
void print_imu_calibration(const nlohmann::json& calibration);

}  // namespace stillkite
