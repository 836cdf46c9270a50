#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>

#include "geometry/rigid_transform.hpp"
#include "navigation/navigation_estimate.hpp"

namespace stillkite {

/// What a report tells of one run.
struct ReportContent {
  std::string title;  ///< the source, as the user named it
  std::span<const NavigationEstimate> estimates;
  std::span<const std::optional<RigidTransform>> truth;  ///< world_from_body; empty, or one each
  RigidTransform body_from_camera;
  std::string config_yaml;  ///< the effective configuration
};

/// One self-contained HTML page: figures 3, 4 and 5 of the flow paper, errors against the truth,
/// flow quality, times, verdicts, the summary (summary.json) and the configuration. Any text may
/// hold anything; values that are not finite become gaps.
[[nodiscard]] std::string report_html(const ReportContent& content, const nlohmann::json& summary);

/// As a file; throws as write_file does.
void write_report(const std::filesystem::path& path, const ReportContent& content,
                  const nlohmann::json& summary);

}  // namespace stillkite
