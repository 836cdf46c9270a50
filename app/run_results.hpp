#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "app/run_record.hpp"
#include "io/config/run_config.hpp"

namespace stillkite {

/// Evaluates a run against its truth, if any, and writes summary.json and report.html. Returns the
/// summary.
nlohmann::json write_run_results(const std::filesystem::path& folder, const RunConfig& config,
                                 const FlightInputs& inputs, const RunRecord& record,
                                 const RunFacts& facts);

/// Prints the summary's main figures.
void print_run_results(const nlohmann::json& summary, const RunTally& tally,
                       const std::filesystem::path& folder);

}  // namespace stillkite
