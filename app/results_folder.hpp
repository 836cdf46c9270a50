#pragma once

#include <filesystem>
#include <vector>

#include "io/config/run_config.hpp"

namespace stillkite {

/// What was asked for, else out/NAME by the configuration's name; of a simulated flight's run.yaml
/// out/run-FLIGHT.
[[nodiscard]] std::filesystem::path results_folder(const std::filesystem::path& asked_for,
                                                   const std::filesystem::path& config);

/// What a run reads, its configuration among it.
[[nodiscard]] std::vector<std::filesystem::path> inputs_of_run(
    const std::filesystem::path& config_file, const RunConfig& config);

/// Removes what an earlier `run` or `compare` has written there, for it would be taken for this
/// call's: files of their names, in the folder and in those of the estimators that its
/// comparison.json lists, but none of the `inputs`.
void remove_earlier_results(const std::filesystem::path& folder,
                            const std::vector<std::filesystem::path>& inputs);

/// Throws InputError where what `run` writes there would take the place of what it reads.
void protect_inputs_of_run(const std::filesystem::path& folder,
                           const std::filesystem::path& config_file, const RunConfig& config);

}  // namespace stillkite
