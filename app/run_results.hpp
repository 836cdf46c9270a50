#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "io/config/run_config.hpp"
#include "io/dataset/flight_inputs.hpp"
#include "io/results/run_recorder.hpp"
#include "io/results/run_summary.hpp"

namespace stillkite {

/// Evaluates a run against its truth, if any, and writes summary.json and report.html. Returns the
/// summary.
nlohmann::json write_run_results(const std::filesystem::path& folder, const RunConfig& config,
                                 const FlightInputs& inputs,
                                 const std::vector<NavigationEstimate>& estimates,
                                 const RunFacts& facts);

/// Prints the summary's main figures.
void print_run_results(const nlohmann::json& summary,
                       const std::vector<NavigationEstimate>& estimates,
                       const std::filesystem::path& folder);

}  // namespace stillkite
