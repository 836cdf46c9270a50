#include "io/report/calibration_report.hpp"

#include <nlohmann/json.hpp>

#include "io/report/assets.hpp"
#include "io/report/base64.hpp"
#include "io/report/report_page.hpp"

namespace stillkite {
namespace {

std::string component(const std::vector<Eigen::Vector2f>& points, int index) {
  std::vector<float> values;
  for (const Eigen::Vector2f& point : points) values.push_back(point(index));
  return base64(values);
}

}  // namespace

std::string calibration_report_html(const std::string& title, const std::string& config_yaml,
                                    const nlohmann::json& calibration,
                                    const CalibrationReportCorners& corners) {
  return report_page({.brand = "Stillkite calibration",
                      .main = report_assets::kCalibrationMain,
                      .style = report_assets::kCalibrationStyle,
                      .script = report_assets::kCalibrationScript,
                      .reset = "",
                      .footer = "Residual: measured minus projected corner.",
                      .title = title,
                      .config_yaml = config_yaml},
                     {{"summary", calibration},
                      {"corners",
                       {{"x", component(corners.pixels, 0)},
                        {"y", component(corners.pixels, 1)},
                        {"dx", component(corners.residuals_px, 0)},
                        {"dy", component(corners.residuals_px, 1)}}}});
}

}  // namespace stillkite
