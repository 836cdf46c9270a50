#include "app/hover_estimates.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "app/hover_results.hpp"

namespace stillkite {
namespace {

TEST(HoverEstimates, MatchesClosedFormFigures) {
  TrialRecord record;
  record.estimate_errors.resize(20);
  for (std::size_t i = 0; i < 20; ++i) {
    EstimateError& error = record.estimate_errors[i];
    error.verdict = i == 0 ? Verdict::first_frame : i < 15 ? Verdict::ok : Verdict::lost;
    error.position_error_m = i % 2 == 0 ? 0.03 : 0.04;
    error.velocity_error_m_s = 0.01 * static_cast<double>(i + 1);
    if (i > 0) error.pose_nees = i < 10 ? 4 : 8;
  }
  const nlohmann::json found = hover_estimate_json(std::vector{record});
  EXPECT_NEAR(found["position_rmse_m"], std::sqrt((9e-4 + 16e-4) / 2), 1e-12);
  // 1^2 + ... + 20^2 = 2870
  EXPECT_NEAR(found["velocity_rmse_m_s"], 0.01 * std::sqrt(2870.0 / 20), 1e-12);
  EXPECT_NEAR(found["velocity_p95_m_s"], 0.19, 1e-12);
  EXPECT_NEAR(found["nees_mean"], (9 * 4 + 10 * 8) / 19.0, 1e-12);
  EXPECT_NEAR(found["available_ratio"], 15.0 / 20, 1e-12);
  EXPECT_NE(hover_estimate_line(found).find("available 75.0 %"), std::string::npos);
}

TEST(HoverEstimates, IsNullWithoutMetricScaleOrImages) {
  TrialRecord reference;
  reference.estimate_errors.resize(2);
  reference.estimate_errors[1].verdict = Verdict::gated;
  TrialRecord off;
  off.trial.stabilized = false;
  const nlohmann::json summary = hover_summary(std::vector{reference, off}, "reference", 1.0);
  EXPECT_TRUE(summary["trials"][0]["estimate"]["position_rmse_m"].is_null());
  EXPECT_TRUE(summary["trials"][0]["estimate"]["velocity_p95_m_s"].is_null());
  EXPECT_TRUE(summary["trials"][0]["estimate"]["nees_mean"].is_null());
  EXPECT_EQ(summary["trials"][0]["estimate"]["available_ratio"], 0.5);
  EXPECT_TRUE(summary["trials"][1]["estimate"]["available_ratio"].is_null());
  EXPECT_EQ(summary["estimate"], summary["trials"][0]["estimate"]);
}

}  // namespace
}  // namespace stillkite
