#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "geometry/angle.hpp"
#include "simulation/hover/wind.hpp"
#include "simulation/hover/yaw_kicks.hpp"

namespace stillkite {
namespace {

// 20 ft: L_u = 20 / 0.19346^1.2, sigma_u = sigma_w / 0.19346^0.4.
TEST(DrydenWind, MatchesSpecificationScales) {
  const GustScales scales = dryden_scales({.mean_m_s = 8, .height_m = 20 * 0.3048});
  EXPECT_NEAR(scales.deviation_m_s.z(), 0.8, 1e-12);
  EXPECT_NEAR(scales.deviation_m_s.x(), 0.8 / std::pow(0.19346, 0.4), 1e-9);
  EXPECT_NEAR(scales.time_s.z(), 20 * 0.3048 / 8, 1e-12);
  EXPECT_NEAR(scales.time_s.y(), 20 * 0.3048 / std::pow(0.19346, 1.2) / 8, 1e-9);
}

// Variance and autocorrelation of each component, for a small and a large step.
TEST(DrydenWind, MatchesVarianceAndCorrelation) {
  const WindConfig config{.mean_m_s = 6, .towards_deg = 0, .height_m = 3};
  const GustScales scales = dryden_scales(config);
  for (const double step_s : {0.05, 0.4}) {
    constexpr int kSteps = 400000;
    DrydenWind wind(config, 21);
    std::vector<Eigen::Vector3d> gusts;
    gusts.reserve(kSteps);
    for (int k = 0; k < kSteps; ++k) {
      wind.step(step_s);
      gusts.emplace_back(wind.in_world_m_s() - Eigen::Vector3d(6, 0, 0));
    }
    for (int axis = 0; axis < 3; ++axis) {
      const double sigma = scales.deviation_m_s[axis];
      const double T = scales.time_s[axis];
      const auto correlation_at = [&](int lag) {
        double sum = 0;
        for (int k = lag; k < kSteps; ++k) sum += gusts[k][axis] * gusts[k - lag][axis];
        return sum / (kSteps - lag) / (sigma * sigma);
      };
      // three standard deviations for about duration / 2T independent samples
      const double tolerance = 3 * std::sqrt(2 * 2 * T / (kSteps * step_s));
      EXPECT_NEAR(correlation_at(0), 1, tolerance) << axis;
      for (const int lag : {1, 5, 20, 60}) {
        const double ratio = lag * step_s / T;
        const double expected = std::exp(-ratio) * (axis == 0 ? 1 : 1 - ratio / 2);
        EXPECT_NEAR(correlation_at(lag), expected, tolerance) << axis << " " << lag;
      }
    }
  }
}

TEST(DrydenWind, HasConfiguredDirectionAndIsDeterministicInSeed) {
  DrydenWind even({.mean_m_s = 4, .towards_deg = 90, .gusts = false}, 1);
  even.step(1);
  EXPECT_LT((even.in_world_m_s() - Eigen::Vector3d(0, 4, 0)).norm(), 1e-12);
  DrydenWind still({}, 1);
  still.step(1);
  EXPECT_EQ(still.in_world_m_s().norm(), 0);
  DrydenWind one({.mean_m_s = 4}, 1);
  DrydenWind again({.mean_m_s = 4}, 1);
  DrydenWind other({.mean_m_s = 4}, 2);
  for (int k = 0; k < 10; ++k) {
    one.step(0.005);
    again.step(0.005);
    other.step(0.005);
  }
  EXPECT_EQ((one.in_world_m_s() - again.in_world_m_s()).norm(), 0);
  EXPECT_GT((one.in_world_m_s() - other.in_world_m_s()).norm(), 1e-3);
}

TEST(YawKicks, SumToTheirAnglesForAnyStep) {
  const YawKickConfig config{.every_s = 10};
  const std::vector<YawKick> kicks = make_yaw_kicks(config, 105, 4);
  ASSERT_EQ(kicks.size(), 9u);
  double sum_rad = 0;
  for (std::size_t k = 0; k < kicks.size(); ++k) {
    EXPECT_NEAR(kicks[k].at_s, 10.0 * static_cast<double>(k + 1), 1e-9);
    EXPECT_EQ(kicks[k].duration_s > 0, k % 2 == 1);
    EXPECT_LE(std::abs(kicks[k].angle_rad), 20 * kDegree);
    EXPECT_GE(std::abs(kicks[k].angle_rad), 5 * kDegree);
    sum_rad += kicks[k].angle_rad;
  }
  EXPECT_NEAR(kick_yaw_rad(kicks, 0, 105), sum_rad, 1e-12);
  double stepwise_rad = 0;
  for (int k = 0; k < 21000; ++k) stepwise_rad += kick_yaw_rad(kicks, k * 0.005, (k + 1) * 0.005);
  EXPECT_NEAR(stepwise_rad, sum_rad, 1e-9);
  // half of a gust's angle at half of its duration
  EXPECT_NEAR(kick_yaw_rad({{.at_s = 1, .duration_s = 2, .angle_rad = 0.3}}, 0, 2), 0.15, 1e-12);
  EXPECT_THROW((void)make_yaw_kicks({.largest_deg = 3}, 100, 1), InputError);
}

}  // namespace
}  // namespace stillkite
