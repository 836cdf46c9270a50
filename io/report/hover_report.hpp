#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace stillkite {

/// One instant of a trial. What is not known is NaN.
struct HoverReportSample {
  double t_s = 0;  ///< from the trial's start
  /// From the place at the start, along the hold paper's axes: x and z are level, y is up.
  Eigen::Vector3d displacement_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d station_in_world_m = Eigen::Vector3d::Zero();  ///< z is up
  Eigen::Vector3d drone_in_world_m = Eigen::Vector3d::Zero();
  double yaw_deg = 0;       ///< from the heading at the start, left is +
  std::string_view action;  ///< token of HoldAction, empty without stabilization
  std::string_view reason;  ///< token of HoldReason
};

struct HoverImage {
  double t_s = 0;
  std::vector<std::uint8_t> jpeg;
};

struct HoverReportTrial {
  int moved_axis = 0;  ///< the station's: 0, 1, 2 are the paper's x, y, z
  bool stabilized = true;
  std::string policy;
  std::uint64_t seed = 0;
  std::vector<HoverReportSample> samples;
  std::vector<HoverImage> images;  ///< of the drone's camera, small; may be empty
};

/// What a report tells of a set of trials. The views are read before the call returns.
struct HoverReportContent {
  std::string title;  ///< the configuration, as the user named it
  std::span<const HoverReportTrial> trials;
  std::string config_yaml;  ///< the effective configuration
};

/// One self-contained HTML page: Table I beside the hold paper's, its figures 3, 4 and 5, a replay
/// with the camera's images, the decisions and the configuration. `summary` is summary.json
/// (its `table`, `trials` and `timing`). Any text may hold anything; values that are not finite
/// become gaps. Stays below 3 MB: long trials are thinned for drawing, many images too.
/// Throws std::out_of_range for another `moved_axis`.
[[nodiscard]] std::string hover_report_html(const HoverReportContent& content,
                                            const nlohmann::json& summary);

/// As a file; throws as write_file does.
void write_hover_report(const std::filesystem::path& path, const HoverReportContent& content,
                        const nlohmann::json& summary);

}  // namespace stillkite
