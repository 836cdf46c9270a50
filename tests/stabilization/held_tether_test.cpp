#include "stabilization/held_tether.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "geometry/angle.hpp"

namespace stillkite {
namespace {

constexpr double kHeldLag_s = 0.5;
const TetherState kKeptOverhead{2, std::numbers::pi / 2, 0};

TEST(HeldTether, FollowsItsCommandsWithTheLag) {
  HeldTether held(kHeldLag_s);
  held.advance(from_seconds(0));
  (void)held.take(kKeptOverhead);
  held.set_command({.elevation_rate_rad_s = -0.2, .azimuth_rate_rad_s = 0.1});
  for (int i = 1; i <= 30; ++i) held.advance(from_seconds(0.1 * i));
  const TetherState state = held.take(kKeptOverhead);
  // r' = (u - r) / lag from rest: u (t - lag (1 - exp(-t / lag)))
  const double way_s = 3 - kHeldLag_s * (1 - std::exp(-3 / kHeldLag_s));
  EXPECT_NEAR(state.elevation_rad, std::numbers::pi / 2 - 0.2 * way_s, 1e-9);
  EXPECT_NEAR(state.azimuth_rad, 0.1 * way_s, 1e-9);
}

// Blown aside at the zenith, the drone is still kept there: the elevation moves it along its old
// azimuth, not along the one at which it is seen.
TEST(HeldTether, WindTurnsNothing) {
  HeldTether held(kHeldLag_s);
  held.advance(from_seconds(0));
  (void)held.take(kKeptOverhead);
  held.advance(from_seconds(1));
  const TetherState state = held.take({2.1, 1.4, 1.5});
  EXPECT_EQ(state.length_m, 2.1);
  EXPECT_EQ(state.elevation_rad, kKeptOverhead.elevation_rad);
  EXPECT_EQ(state.azimuth_rad, kKeptOverhead.azimuth_rad);
}

TEST(HeldTether, WindBeforeTheFirstReadingTurnsNothing) {
  HeldTether held(kHeldLag_s);
  held.advance(from_seconds(0));
  const TetherState overhead = held.take({2, 84 * kDegree, 90 * kDegree});
  EXPECT_EQ(overhead.elevation_rad, kKeptOverhead.elevation_rad);
  EXPECT_EQ(overhead.azimuth_rad, 0);
  HeldTether lower(kHeldLag_s);
  lower.advance(from_seconds(0));
  EXPECT_EQ(lower.take({2, 60 * kDegree, 90 * kDegree}).azimuth_rad, 90 * kDegree);
}

TEST(HeldTether, BelievesAReadingThatNoWindExplains) {
  HeldTether held(kHeldLag_s);
  held.advance(from_seconds(0));
  (void)held.take(kKeptOverhead);
  EXPECT_EQ(held.take({2, 0.3, 0.5}).elevation_rad, 0.3);
}

}  // namespace
}  // namespace stillkite
