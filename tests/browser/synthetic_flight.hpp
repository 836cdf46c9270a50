#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/report/report.hpp"

namespace stillkite {

/// Synthetic run similar to the flow paper's flight: 1 km forward, 100 m sideways, 50 m descent;
/// with noise, drift, a few rejected frames, and truth.
struct SyntheticFlight {
  std::vector<NavigationEstimate> estimates;
  std::vector<std::optional<RigidTransform>> truth;
  std::string config_yaml;

  [[nodiscard]] ReportContent content(const std::string& title, bool with_truth) const;
};

[[nodiscard]] SyntheticFlight synthetic_flight(int frames);

/// Charts of estimates with their truth; `truth` is empty or has one pose per estimate.
[[nodiscard]] FlightCharts recorded_charts(std::span<const NavigationEstimate> estimates,
                                           std::span<const std::optional<RigidTransform>> truth,
                                           const RigidTransform& body_from_camera = {});

/// summary.json of the flight, with truth.
[[nodiscard]] nlohmann::json synthetic_summary(const SyntheticFlight& flight);

}  // namespace stillkite
