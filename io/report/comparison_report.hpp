#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>

#include "geometry/rigid_transform.hpp"
#include "navigation/navigation_estimate.hpp"

namespace stillkite {

/// One estimator's answers to the frames that all have seen.
struct ComparedEstimates {
  std::string name;
  std::span<const NavigationEstimate> estimates;
  std::span<const float> frame_ms;  ///< one an estimate
};

/// What a report of several estimators tells. Runs of unequal length are cut to the shortest.
struct ComparisonReportContent {
  std::string title;  ///< the configuration, as the user named it
  std::span<const ComparedEstimates> runs;
  std::span<const std::optional<RigidTransform>> truth;  ///< world_from_body; empty, or one a frame
  std::string config_yaml;                               ///< the effective configurations
};

/// One self-contained HTML page: the table of comparison.json (`comparison`) with what is
/// significant, verdicts one above the other, and overlaid charts, a colour an estimator. Any text
/// may hold anything; values that are not finite become gaps. Of an estimate without a scale beside
/// others with one no lengths are drawn.
[[nodiscard]] std::string comparison_report_html(const ComparisonReportContent& content,
                                                 const nlohmann::json& comparison);

/// As a file; throws as write_file does.
void write_comparison_report(const std::filesystem::path& path,
                             const ComparisonReportContent& content,
                             const nlohmann::json& comparison);

}  // namespace stillkite
