#include "io/report/calibration_report.hpp"

#include <nlohmann/json.hpp>

#include "tests/browser/browser_test.hpp"

namespace stillkite {
namespace {

using nlohmann::json;

json small_calibration() {
  return {{"image", {{"width_px", 640}, {"height_px", 480}}},
          {"views", {{"frames", 20}, {"found", 12}, {"different", 11}, {"selected", 2}}},
          {"model", "no distortion"},
          {"parameters",
           {{{"name", "focal_x_px"}, {"value", 461.23456}, {"sigma", 0.0312}},
            {{"name", "k1"}, {"value", -0.20016}, {"sigma", 0.00042}}}},
          {"horizontal_fov_deg", 69.5},
          {"corner_sigma_px", 0.05},
          {"lens_sigma_px", 0.04},
          {"models",
           {{{"name", "no distortion"},
             {"parameters", 4},
             {"held_out_rms_px", 0.0512},
             {"selected", true}}}},
          {"unseen_corners", {"lower right"}},
          {"selected",
           {{{"frame", 3}, {"t_s", 0.1}, {"corners", 2}, {"tilt_deg", 31.2}, {"rms_px", 0.04}}}}};
}

CalibrationReportCorners two_corners() {
  return {.pixels = {{100, 100}, {500, 300}}, .residuals_px = {{0.05F, 0}, {0, -0.05F}}};
}

using CalibrationInBrowser = BrowserTest;

TEST_F(CalibrationInBrowser, ShowsCoverageResidualsAndValues) {
  const std::string dom =
      show(calibration_report_html("board", "", small_calibration(), two_corners()));
  EXPECT_EQ(root_data(dom, "errors"), std::nullopt);
  EXPECT_EQ(root_data(dom, "ready"), "2");
  EXPECT_EQ(count(dom, "<circle"), 2) << "one per corner";
  EXPECT_EQ(count(dom, "class=\"residual\""), 2);
  EXPECT_EQ(count(dom, "class=\"unseen\""), 1);
  EXPECT_NE(dom.find("<td>461.235</td><td>0.031</td>"), std::string::npos);
  EXPECT_NE(dom.find("Never seen in the lower right"), std::string::npos);
}

TEST_F(CalibrationInBrowser, EscapesTextsAndRendersWithoutCorners) {
  const std::string hostile = "</script><script>document.title='owned'</script>{{data}}'\"&";
  json calibration = small_calibration();
  calibration["unseen_corners"] = {hostile};
  const std::string dom = show(calibration_report_html(hostile, hostile, calibration, {}));
  EXPECT_EQ(root_data(dom, "errors"), std::nullopt);
  EXPECT_EQ(root_data(dom, "ready"), "0");
  EXPECT_EQ(dom.find("<title>owned"), std::string::npos);
}

}  // namespace
}  // namespace stillkite
