#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace stillkite {

struct ReplayArguments {
  std::filesystem::path record;
  std::vector<std::string> overrides;
  std::filesystem::path out;
  bool json = false;
};

/// Estimates the motion from a recorded flight: the same frames and telemetry in the same order as
/// in flight. Writes the results of `run`. Throws as `run` does.
void replay_flight(const ReplayArguments& arguments);

}  // namespace stillkite
