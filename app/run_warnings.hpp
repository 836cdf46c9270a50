#pragma once

#include <filesystem>
#include <span>

#include "app/estimator_run.hpp"

// Messages of a run on standard error.

namespace stillkite {

/// Warns of a missing metric scale, of no ground in the initial view, of rejected IMU readings and
/// of inputs that an estimator does not use. Prints each message once for all estimators.
void report_input_warnings(std::span<const EstimatorRun> runs);

/// Warns of an inconsistency between images and gyroscope, else of an initial attitude error.
void report_inconsistencies(const EstimatorRun& run);

/// Reports problems of the source, logs and truth that do not cover the flight, static overlays
/// outside the mask, and the results folder of a run that stopped early.
void report_outcome(const RunOutcome& outcome, std::span<const EstimatorRun> runs,
                    const std::filesystem::path& out);

}  // namespace stillkite
