#pragma once

#include <filesystem>
#include <vector>

#include "io/config/run_config.hpp"

namespace stillkite {

/// Name of a configuration file without extension; of the run.yaml of a simulated flight its
/// folder.
[[nodiscard]] std::string flight_name(const std::filesystem::path& config);

/// Requested folder, by default out/CONFIG; for the run.yaml of a simulated flight out/run-FLIGHT.
[[nodiscard]] std::filesystem::path results_folder(const std::filesystem::path& requested,
                                                   const std::filesystem::path& config);

/// Input files of a run, configuration included.
[[nodiscard]] std::vector<std::filesystem::path> inputs_of_run(
    const std::filesystem::path& config_file, const RunConfig& config);

/// Removes the results of an earlier `run` or `compare`: files with their names in the folder and
/// in the folders of the estimators that its comparison.json lists, except the `inputs`.
void remove_earlier_results(const std::filesystem::path& folder,
                            const std::vector<std::filesystem::path>& inputs);

/// Throws InputError if a result of `run` in `folder` would overwrite an input.
void protect_inputs_of_run(const std::filesystem::path& folder,
                           const std::filesystem::path& config_file, const RunConfig& config);

}  // namespace stillkite
