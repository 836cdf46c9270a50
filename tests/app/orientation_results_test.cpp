#include "app/orientation_results.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "geometry/angle.hpp"

namespace stillkite {
namespace {

// Yaw steps of `angles_deg` at 10, 20, ... s; exponential decay, time constant 1 s.
TrialRecord decaying(const std::vector<double>& angles_deg) {
  TrialRecord record;
  for (std::size_t i = 0; i < angles_deg.size(); ++i) {
    record.kicks.push_back(
        {.at_s = 10.0 * static_cast<double>(i + 1), .angle_rad = angles_deg[i] * kDegree});
  }
  const int samples = 1000 * (static_cast<int>(angles_deg.size()) + 1);
  for (int i = 0; i < samples; ++i) {
    TrialSample sample;
    sample.t_s = 0.01 * i;
    for (const YawKick& kick : record.kicks) {
      if (sample.t_s >= kick.at_s) {
        sample.yaw_rad += kick.angle_rad * std::exp(kick.at_s - sample.t_s);
      }
    }
    record.samples.push_back(sample);
  }
  return record;
}

TEST(OrientationResults, ReportsSettlingTimePerKick) {
  TrialRecord off = decaying({20});
  off.trial.stabilized = false;
  const std::vector<TrialRecord> records{decaying({15, -20, 2}), off, decaying({10})};
  const nlohmann::json found = orientation_summary(records);
  ASSERT_EQ(found["kicks"].size(), 4u);
  EXPECT_NEAR(found["kicks"][0]["settled_s"], std::log(5.0), 0.011);
  EXPECT_NEAR(found["kicks"][1]["settled_s"], std::log(20.0 / 3), 0.011);
  EXPECT_EQ(found["kicks"][2]["settled_s"], 0);
  EXPECT_EQ(found["kicks"][3]["trial"], 2);
  EXPECT_EQ(found["settling"]["kicks"], 4);
  EXPECT_EQ(found["settling"]["within_5_s"], 4);
  EXPECT_NEAR(found["settling"]["worst_s"], std::log(20.0 / 3), 0.011);
  EXPECT_NEAR(found["settling"]["median_s"], std::log(10.0 / 3), 0.011);
  EXPECT_NEAR(found["table"]["on"]["all"]["max_deg"], 20, 0.01);
  EXPECT_NEAR(found["table"]["off"]["x"]["max_deg"], 20, 1e-9);
  EXPECT_TRUE(found["table"]["on"]["z"]["max_deg"].is_null());
  EXPECT_NE(orientation_table(found).find("4 within 5 s"), std::string::npos);
}

TEST(OrientationResults, TreatsUnsettledKickAsWorst) {
  TrialRecord record = decaying({10, 20});
  for (TrialSample& sample : record.samples) {
    if (sample.t_s >= 20) sample.yaw_rad = 0.2;
  }
  const nlohmann::json found = orientation_summary(std::vector{record});
  EXPECT_TRUE(found["kicks"][1]["settled_s"].is_null());
  EXPECT_TRUE(found["settling"]["worst_s"].is_null());
  EXPECT_EQ(found["settling"]["within_5_s"], 1);
}

TEST(OrientationResults, IsNullWithoutKicks) {
  EXPECT_TRUE(orientation_summary(std::vector{decaying({})}).is_null());
  EXPECT_EQ(orientation_table(nullptr), "");
}

}  // namespace
}  // namespace stillkite
