#pragma once

#include <filesystem>
#include <vector>

#include "io/run_config.hpp"

namespace stillkite {

/// What was asked for, else out/NAME by the configuration's name; of a simulated flight's run.yaml
/// out/run-FLIGHT.
[[nodiscard]] std::filesystem::path results_folder(const std::filesystem::path& asked_for,
                                                   const std::filesystem::path& config);

/// Throws InputError where what `run` writes there would take the place of what it reads.
void protect_inputs_of_run(const std::filesystem::path& folder,
                           const std::filesystem::path& config_file, const RunConfig& config);

}  // namespace stillkite
