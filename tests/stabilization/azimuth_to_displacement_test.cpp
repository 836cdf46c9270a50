#include "stabilization/azimuth_to_displacement.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <numbers>

namespace stillkite {
namespace {

using Eigen::Vector2d;
using std::numbers::pi;

constexpr AzimuthDrive kDrive{.rate_limit_rad_s = 0.2, .lag_s = 0.5};
constexpr double kHorizon_s = 8;

double turn(double azimuth_rad, const Vector2d& now_m, const Vector2d& drift_m_s) {
  return azimuth_to_displacement_rad_s(azimuth_rad, {now_m, drift_m_s}, kDrive, kHorizon_s);
}

Vector2d at(double distance_m, double azimuth_rad) {
  return distance_m * Vector2d(std::cos(azimuth_rad), std::sin(azimuth_rad));
}

TEST(AzimuthToDisplacement, NothingWhereTheWayStaysInThePlane) {
  EXPECT_EQ(turn(0.4, Vector2d::Zero(), Vector2d::Zero()), 0);
  EXPECT_NEAR(turn(0.4, at(1, 0.4), at(0.2, 0.4)), 0, 1e-6);
  EXPECT_NEAR(turn(0.4, at(1, 0.4 + pi), at(0.2, 0.4)), 0, 1e-6);  // across the zenith
}

TEST(AzimuthToDisplacement, TurnsTheShorterWayToAPlaceThatStays) {
  for (const double off_rad : {0.3, 1.2}) {
    EXPECT_NEAR(turn(2, at(1, 2 + off_rad), Vector2d::Zero()), 0.2, 1e-6) << off_rad;
    EXPECT_NEAR(turn(2, at(1, 2 - off_rad), Vector2d::Zero()), -0.2, 1e-6) << off_rad;
    // the plane holds what is on the other side as well
    EXPECT_NEAR(turn(2, at(1, 2 + pi - off_rad), Vector2d::Zero()), -0.2, 1e-6) << off_rad;
  }
  const double little = turn(2, at(1, 2.03), Vector2d::Zero());
  EXPECT_GT(little, 0.02);
  EXPECT_LT(little, 0.15);
}

TEST(AzimuthToDisplacement, IsNotMovedByMillimetres) {
  EXPECT_LT(std::abs(turn(0, Vector2d(0, 0.002), Vector2d::Zero())), 0.03);
  EXPECT_GT(std::abs(turn(0, Vector2d(0, 0.05), Vector2d::Zero())), 0.15);
}

// A way that passes overhead at some distance turns by half a circle about the zenith. Far enough
// aside the azimuth goes with it; nearer than its rate allows it goes the other way round, and the
// elevation takes the drone across the zenith.
TEST(AzimuthToDisplacement, LetsWhatPassesTooNearPassOnTheOtherSide) {
  const auto passing = [](double aside_m, double ahead_m) {
    const double azimuth_rad = std::atan2(aside_m, ahead_m);
    return turn(azimuth_rad, {ahead_m, aside_m}, {-0.2, 0});
  };
  EXPECT_GT(passing(1.5, 0.4), 0.1);
  EXPECT_LT(passing(0.2, 0.4), -0.1);
  EXPECT_LT(passing(-1.5, 0.4), -0.1);
  EXPECT_GT(passing(-0.2, 0.4), 0.1);
}

// Root of the mean square of what the way is off the plane, from 2 m before the zenith to behind
// it.
double off_while_passing_m(double aside_m) {
  constexpr double kStep_s = 0.02, kSpeed_m_s = 0.2;
  double azimuth_rad = std::atan2(aside_m, 2), rate_rad_s = 0, sum_m2 = 0;
  int count = 0;
  for (double ahead_m = 2; ahead_m > -2; ahead_m -= kSpeed_m_s * kStep_s, ++count) {
    const Vector2d here(ahead_m, aside_m);
    const double command = turn(azimuth_rad, here, {-kSpeed_m_s, 0});
    rate_rad_s += (command - rate_rad_s) * kStep_s / kDrive.lag_s;
    azimuth_rad += rate_rad_s * kStep_s;
    const double off_m = here.norm() * std::sin(azimuth_rad - std::atan2(here.y(), here.x()));
    sum_m2 += off_m * off_m;
  }
  return std::sqrt(sum_m2 / count);
}

// Far aside it goes round, near it across; in between neither is near.
TEST(AzimuthToDisplacement, PassesTheZenithTheBetterWay) {
  EXPECT_LT(off_while_passing_m(0.1), 0.035);
  EXPECT_LT(off_while_passing_m(0.3), 0.12);
  EXPECT_LT(off_while_passing_m(0.4), 0.18);
  EXPECT_LT(off_while_passing_m(0.5), 0.21);
  EXPECT_LT(off_while_passing_m(0.6), 0.14);
  EXPECT_LT(off_while_passing_m(0.8), 0.045);
  EXPECT_LT(off_while_passing_m(1.0), 0.05);
}

TEST(AzimuthToDisplacement, NothingForWhatCannotBe) {
  EXPECT_EQ(turn(0, Vector2d(0, std::nan("")), Vector2d::Zero()), 0);
  EXPECT_EQ(turn(0, Vector2d(0, 1), Vector2d(1e300, 1e300)), 0);
  EXPECT_EQ(
      azimuth_to_displacement_rad_s(0, {Vector2d(0, 1), Vector2d::Zero()}, {0, 0.5}, kHorizon_s),
      0);
}

TEST(AzimuthToDisplacement, NeverBeyondTheLimit) {
  for (int k = 0; k < 500; ++k) {
    const double phase = 0.1 * k;
    const double rate = turn(std::sin(7 * phase) * 4, at(std::fmod(phase, 3), phase),
                             at(0.3 * std::sin(3 * phase), 2 * phase));
    ASSERT_LE(std::abs(rate), 0.2 + 1e-12);
  }
}

}  // namespace
}  // namespace stillkite
