#pragma once

#include <filesystem>

#include "app/fly_config.hpp"

namespace stillkite {

/// Throws InputError if a file that the record needs cannot be read.
void check_recorded_files(const FlyConfig& config);

/// Writes the configuration into the folder of a record, without password, with copies of
/// calibration and mask: the record can be read without other files. Throws InputError.
void write_recorded_config(FlyConfig config, const std::filesystem::path& folder);

}  // namespace stillkite
