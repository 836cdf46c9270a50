#pragma once

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace stillkite {

/// Corners of all views with their residuals, measured - projected.
struct CalibrationReportCorners {
  std::vector<Eigen::Vector2f> pixels;
  std::vector<Eigen::Vector2f> residuals_px;
};

/// Self-contained HTML page of calibration.json (`calibration`): coverage of the image, residuals,
/// values with standard deviations, held-out errors of the lens models. Texts are escaped.
[[nodiscard]] std::string calibration_report_html(const std::string& title,
                                                  const std::string& config_yaml,
                                                  const nlohmann::json& calibration,
                                                  const CalibrationReportCorners& corners);

}  // namespace stillkite
