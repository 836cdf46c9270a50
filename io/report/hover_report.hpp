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

/// Sample of a trial; unknown values are NaN.
struct HoverReportSample {
  double t_s = 0;  ///< since the start of the trial
  /// Relative to the initial position, in the axes of the hold paper: x, z horizontal, y up.
  Eigen::Vector3d displacement_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d station_in_world_m = Eigen::Vector3d::Zero();  ///< z is up
  Eigen::Vector3d drone_in_world_m = Eigen::Vector3d::Zero();
  double yaw_deg = 0;       ///< relative to the initial heading, positive left
  std::string_view action;  ///< name of HoldAction, empty without stabilization
  std::string_view reason;  ///< name of HoldReason
};

struct HoverImage {
  double t_s = 0;
  std::vector<std::uint8_t> jpeg;
};

struct HoverReportTrial {
  int moved_axis = 0;  ///< axis of the station's motion: 0, 1, 2 = x, y, z of the paper
  bool stabilized = true;
  std::string policy;
  std::uint64_t seed = 0;
  std::vector<HoverReportSample> samples;
  std::vector<HoverImage> images;  ///< thumbnails of the drone's camera; may be empty
};

/// Content of a hover report.
struct HoverReportContent {
  std::string title;  ///< configuration file as given by the user
  std::span<const HoverReportTrial> trials;
  std::string config_yaml;  ///< effective configuration
};

/// Self-contained HTML page below 3 MB: Table I next to the hold paper's, figures 3 to 5, replay
/// with camera images, controller decisions and configuration. `summary`: summary.json (`table`,
/// `trials`, `timing`). Texts are escaped; non-finite values become gaps; long trials and images
/// are decimated. Throws std::out_of_range on an invalid `moved_axis`.
[[nodiscard]] std::string hover_report_html(const HoverReportContent& content,
                                            const nlohmann::json& summary);

/// Writes the page to a file; throws as write_file.
void write_hover_report(const std::filesystem::path& path, const HoverReportContent& content,
                        const nlohmann::json& summary);

}  // namespace stillkite
