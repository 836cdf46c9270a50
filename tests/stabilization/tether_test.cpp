#include "stabilization/tether.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace stillkite {
namespace {

using std::numbers::pi;

TEST(Tether, PositionFollowsEquationsNineToEleven) {
  const Eigen::Vector3d p = position_in_station({10, pi / 6, pi / 3});
  EXPECT_NEAR(p.x(), 10 * std::sqrt(0.75) * 0.5, 1e-12);
  EXPECT_NEAR(p.y(), 10 * std::sqrt(0.75) * std::sqrt(0.75), 1e-12);
  EXPECT_NEAR(p.z(), 5, 1e-12);
}

TEST(Tether, InverseRecoversTheState) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> length_m(1e-3, 20);
  std::uniform_real_distribution<double> elevation_rad(0, pi);
  std::uniform_real_distribution<double> azimuth_rad(-10, 10);
  std::uniform_real_distribution<double> offset_rad(-0.3, 0.3);
  for (int k = 0; k < 10000; ++k) {
    const TetherState truth{length_m(random), elevation_rad(random), azimuth_rad(random)};
    const TetherState near{length_m(random), truth.elevation_rad + offset_rad(random),
                           truth.azimuth_rad + offset_rad(random)};
    const TetherState found = tether_to(position_in_station(truth), near);
    const double horizontal_ratio = std::abs(std::cos(truth.elevation_rad));
    ASSERT_NEAR(found.length_m, truth.length_m, 1e-12 * truth.length_m);
    ASSERT_LT((position_in_station(found) - position_in_station(truth)).norm(), 1e-12 * 20);
    if (horizontal_ratio < 0.3) continue;  // the other solution may be nearer
    ASSERT_NEAR(found.elevation_rad, truth.elevation_rad, 1e-9);
    ASSERT_NEAR(found.azimuth_rad, truth.azimuth_rad, 1e-9);
  }
}

TEST(Tether, SingularStatesKeepTheAzimuth) {
  const TetherState near{5, 1.2, 0.7};
  const TetherState zenith = tether_to({0, 0, 3}, near);
  EXPECT_DOUBLE_EQ(zenith.length_m, 3);
  EXPECT_DOUBLE_EQ(zenith.elevation_rad, pi / 2);
  EXPECT_DOUBLE_EQ(zenith.azimuth_rad, 0.7);
  const TetherState origin = tether_to({0, 0, 0}, near);
  EXPECT_DOUBLE_EQ(origin.length_m, 0);
  EXPECT_DOUBLE_EQ(origin.elevation_rad, 1.2);
  EXPECT_DOUBLE_EQ(origin.azimuth_rad, 0.7);
  const TetherState full = tether_to(position_in_station({20, 0, -3}), {20, 0, -3});
  EXPECT_NEAR(full.length_m, 20, 1e-12);
  EXPECT_NEAR(full.elevation_rad, 0, 1e-12);
  EXPECT_NEAR(full.azimuth_rad, -3, 1e-12);
}

TEST(Tether, StraightLineThroughZenithIsSmooth) {
  for (const double heading_rad : {0.0, 0.9, pi, -2.0}) {
    const Eigen::Vector3d ahead(std::cos(heading_rad), std::sin(heading_rad), 0);
    TetherState now = tether_to(2 * ahead + 2 * Eigen::Vector3d::UnitZ(), {0, 0, heading_rad});
    for (int k = 1; k <= 400; ++k) {
      const double along_m = 2 - 0.01 * k;
      const TetherState next = tether_to(along_m * ahead + 2 * Eigen::Vector3d::UnitZ(), now);
      ASSERT_NEAR(next.azimuth_rad, heading_rad, 1e-9) << along_m;
      ASSERT_NEAR(next.elevation_rad, std::atan2(2, along_m), 1e-9);
      now = next;
    }
    EXPECT_NEAR(now.elevation_rad, 3 * pi / 4, 1e-9);
  }
}

TEST(Tether, AnglesAreContinuousNearTheZenith) {
  TetherState now = tether_to({2, 0.05, 2}, {});
  for (int k = 1; k <= 40000; ++k) {
    const TetherState next = tether_to({2 - 1e-4 * k, 0.05, 2}, now);
    ASSERT_LT(std::abs(next.azimuth_rad - now.azimuth_rad), 1e-4 / 0.05 + 1e-9);
    ASSERT_LT(std::abs(next.elevation_rad - now.elevation_rad), 1e-4);
    now = next;
  }
}

TEST(Tether, FinitePositionsGiveFiniteStates) {
  constexpr double kTiny = std::numeric_limits<double>::denorm_min();
  const std::array values = {0.0, -0.0, kTiny, -kTiny, 1e-300, 1.0, -1.0, 1e150, -1e150};
  for (const double x : values) {
    for (const double y : values) {
      for (const double z : values) {
        const TetherState t = tether_to({x, y, z}, {1, 1, 1});
        ASSERT_TRUE(std::isfinite(t.length_m) && std::isfinite(t.elevation_rad) &&
                    std::isfinite(t.azimuth_rad));
      }
    }
  }
}

}  // namespace
}  // namespace stillkite
