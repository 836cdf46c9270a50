#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "io/report/report.hpp"

namespace stillkite {

/// A made-up run in the shape of the flow paper's flight: 1 km forward, 100 m aside, 50 m down,
/// with noise, drift and a few bad frames, and its truth.
struct SyntheticFlight {
  std::vector<NavigationEstimate> estimates;
  std::vector<std::optional<RigidTransform>> truth;
  std::string config_yaml;

  [[nodiscard]] ReportContent content(const std::string& title, bool with_truth) const;
};

[[nodiscard]] SyntheticFlight synthetic_flight(int frames);

/// A summary.json as a run of that flight with truth would write it.
[[nodiscard]] nlohmann::json synthetic_summary(const SyntheticFlight& flight);

}  // namespace stillkite
