#include "stabilization/tether_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "geometry/angle.hpp"

namespace stillkite {
namespace {

constexpr double kLag_s = 0.5;
const TetherState kZenith{2, std::numbers::pi / 2, 0};

TEST(TetherModel, FollowsCommandsWithFirstOrderLag) {
  TetherModel model(kLag_s);
  model.advance(from_seconds(0));
  (void)model.update(kZenith);
  model.set_command({.elevation_rate_rad_s = -0.2, .azimuth_rate_rad_s = 0.1});
  for (int i = 1; i <= 30; ++i) model.advance(from_seconds(0.1 * i));
  const TetherState state = model.update(kZenith);
  // r' = (u - r) / lag from rest: u (t - lag (1 - exp(-t / lag)))
  const double response_s = 3 - kLag_s * (1 - std::exp(-3 / kLag_s));
  EXPECT_NEAR(state.elevation_rad, std::numbers::pi / 2 - 0.2 * response_s, 1e-9);
  EXPECT_NEAR(state.azimuth_rad, 0.1 * response_s, 1e-9);
}

// A drone that wind deflects from the zenith keeps its modelled azimuth: the elevation moves it
// along that one, not along the measured azimuth.
TEST(TetherModel, IgnoresWindDeflection) {
  TetherModel model(kLag_s);
  model.advance(from_seconds(0));
  (void)model.update(kZenith);
  model.advance(from_seconds(1));
  const TetherState state = model.update({2.1, 1.4, 1.5});
  EXPECT_EQ(state.length_m, 2.1);
  EXPECT_EQ(state.elevation_rad, kZenith.elevation_rad);
  EXPECT_EQ(state.azimuth_rad, kZenith.azimuth_rad);
}

TEST(TetherModel, InitializesToZenithDespiteWind) {
  TetherModel model(kLag_s);
  model.advance(from_seconds(0));
  const TetherState overhead = model.update({2, 84 * kDegree, 90 * kDegree});
  EXPECT_EQ(overhead.elevation_rad, kZenith.elevation_rad);
  EXPECT_EQ(overhead.azimuth_rad, 0);
  TetherModel lower(kLag_s);
  lower.advance(from_seconds(0));
  EXPECT_EQ(lower.update({2, 60 * kDegree, 90 * kDegree}).azimuth_rad, 90 * kDegree);
}

TEST(TetherModel, ResetsToReadingBeyondWindDeflection) {
  TetherModel model(kLag_s);
  model.advance(from_seconds(0));
  (void)model.update(kZenith);
  EXPECT_EQ(model.update({2, 0.3, 0.5}).elevation_rad, 0.3);
}

}  // namespace
}  // namespace stillkite
