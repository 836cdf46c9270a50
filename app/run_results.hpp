#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "io/config/run_config.hpp"
#include "io/dataset/flight_inputs.hpp"
#include "io/results/run_recorder.hpp"
#include "io/results/run_summary.hpp"

namespace stillkite {

/// What a run's frames amount to: its errors where there is truth and a scale to compare it in,
/// summary.json and report.html in the folder. Gives the summary.
nlohmann::json write_run_results(const std::filesystem::path& folder, const RunConfig& config,
                                 const FlightInputs& inputs,
                                 const std::vector<NavigationEstimate>& estimates,
                                 const RunFacts& facts);

/// The summary's main figures, for a person.
void print_run_results(const nlohmann::json& summary,
                       const std::vector<NavigationEstimate>& estimates,
                       const std::filesystem::path& folder);

}  // namespace stillkite
