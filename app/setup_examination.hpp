#pragma once

#include "io/config/run_config.hpp"
#include "io/setup/setup_finding.hpp"

namespace stillkite {

/// Answers to the questions about a flight's set-up, and what they are from.
struct SetupReport {
  SetupFindings findings;
  int frames = 0;
  double duration_s = 0;
};

/// Reads the flight as a run does, and steps flow and reference, without other sensors, through its
/// first 30 s, at most 900 images. An invalid input is a finding; the others are examined without
/// it. Throws Interrupted on Ctrl-C.
[[nodiscard]] SetupReport examine_setup(const RunConfig& config);

}  // namespace stillkite
