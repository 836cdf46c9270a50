#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "app/calibrate_config.hpp"

namespace stillkite {

/// Lens by the views of a board in the images. Writes sensor.yaml, calibration.json and report.html
/// to the folder, all or none, and returns calibration.json. `title`: of the report. Throws
/// InputError if the views do not determine the lens, or leave a corner of the image unseen.
nlohmann::json calibrate_by_board(const CalibrateConfig& config, const std::string& title,
                                  const std::filesystem::path& out);

/// Table of the values on standard output.
void print_board_calibration(const nlohmann::json& calibration);

}  // namespace stillkite
