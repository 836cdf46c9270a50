#include "stabilization/azimuth_to_displacement.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <numbers>

namespace stillkite {
namespace {

using Eigen::Vector2d;
using std::numbers::pi;

constexpr AzimuthDynamics kDynamics{.rate_limit_rad_s = 0.2, .lag_s = 0.5};
constexpr double kHorizon_s = 8;

double rate_for(double azimuth_rad, const Vector2d& position_m, const Vector2d& velocity_m_s) {
  return azimuth_to_displacement_rad_s(azimuth_rad, {position_m, velocity_m_s}, kDynamics,
                                       kHorizon_s);
}

Vector2d at(double distance_m, double azimuth_rad) {
  return distance_m * Vector2d(std::cos(azimuth_rad), std::sin(azimuth_rad));
}

TEST(AzimuthToDisplacement, IsZeroForTargetThatStaysInPlane) {
  EXPECT_EQ(rate_for(0.4, Vector2d::Zero(), Vector2d::Zero()), 0);
  EXPECT_NEAR(rate_for(0.4, at(1, 0.4), at(0.2, 0.4)), 0, 1e-6);
  EXPECT_NEAR(rate_for(0.4, at(1, 0.4 + pi), at(0.2, 0.4)), 0, 1e-6);  // across the zenith
}

TEST(AzimuthToDisplacement, TakesShortestRotationToFixedTarget) {
  for (const double offset_rad : {0.3, 1.2}) {
    EXPECT_NEAR(rate_for(2, at(1, 2 + offset_rad), Vector2d::Zero()), 0.2, 1e-6) << offset_rad;
    EXPECT_NEAR(rate_for(2, at(1, 2 - offset_rad), Vector2d::Zero()), -0.2, 1e-6) << offset_rad;
    // the plane extends to both sides of the zenith
    EXPECT_NEAR(rate_for(2, at(1, 2 + pi - offset_rad), Vector2d::Zero()), -0.2, 1e-6)
        << offset_rad;
  }
  const double small = rate_for(2, at(1, 2.03), Vector2d::Zero());
  EXPECT_GT(small, 0.02);
  EXPECT_LT(small, 0.15);
}

TEST(AzimuthToDisplacement, IgnoresOffsetOfMillimetres) {
  EXPECT_LT(std::abs(rate_for(0, Vector2d(0, 0.002), Vector2d::Zero())), 0.03);
  EXPECT_GT(std::abs(rate_for(0, Vector2d(0, 0.05), Vector2d::Zero())), 0.15);
}

// The azimuth of a target that passes the zenith changes by pi. The azimuth follows a distant
// target; for a close one, beyond its rate limit, it rotates the other way and the elevation
// crosses the zenith.
TEST(AzimuthToDisplacement, LetsCloseTargetPassOnTheOtherSide) {
  const auto passing = [](double aside_m, double ahead_m) {
    const double azimuth_rad = std::atan2(aside_m, ahead_m);
    return rate_for(azimuth_rad, {ahead_m, aside_m}, {-0.2, 0});
  };
  EXPECT_GT(passing(1.5, 0.4), 0.1);
  EXPECT_LT(passing(0.2, 0.4), -0.1);
  EXPECT_LT(passing(-1.5, 0.4), -0.1);
  EXPECT_GT(passing(-0.2, 0.4), 0.1);
}

// RMS distance of the target from the plane, from 2 m before the zenith to 2 m behind it.
double rms_distance_m(double aside_m) {
  constexpr double kStep_s = 0.02, kSpeed_m_s = 0.2;
  double azimuth_rad = std::atan2(aside_m, 2), rate_rad_s = 0, sum_m2 = 0;
  int count = 0;
  for (double ahead_m = 2; ahead_m > -2; ahead_m -= kSpeed_m_s * kStep_s, ++count) {
    const Vector2d target_m(ahead_m, aside_m);
    const double command = rate_for(azimuth_rad, target_m, {-kSpeed_m_s, 0});
    rate_rad_s += (command - rate_rad_s) * kStep_s / kDynamics.lag_s;
    azimuth_rad += rate_rad_s * kStep_s;
    const double distance_m =
        target_m.norm() * std::sin(azimuth_rad - std::atan2(target_m.y(), target_m.x()));
    sum_m2 += distance_m * distance_m;
  }
  return std::sqrt(sum_m2 / count);
}

// The azimuth follows a target at a large lateral distance, and the elevation crosses the zenith at
// a small one; the distance from the plane is largest in between.
TEST(AzimuthToDisplacement, KeepsTargetNearPlaneWhilePassingZenith) {
  EXPECT_LT(rms_distance_m(0.1), 0.035);
  EXPECT_LT(rms_distance_m(0.3), 0.12);
  EXPECT_LT(rms_distance_m(0.4), 0.18);
  EXPECT_LT(rms_distance_m(0.5), 0.21);
  EXPECT_LT(rms_distance_m(0.6), 0.14);
  EXPECT_LT(rms_distance_m(0.8), 0.045);
  EXPECT_LT(rms_distance_m(1.0), 0.05);
}

TEST(AzimuthToDisplacement, IsZeroForNonFiniteTargetOrZeroRateLimit) {
  EXPECT_EQ(rate_for(0, Vector2d(0, std::nan("")), Vector2d::Zero()), 0);
  EXPECT_EQ(rate_for(0, Vector2d(0, 1), Vector2d(1e300, 1e300)), 0);
  EXPECT_EQ(
      azimuth_to_displacement_rad_s(0, {Vector2d(0, 1), Vector2d::Zero()}, {0, 0.5}, kHorizon_s),
      0);
}

TEST(AzimuthToDisplacement, RespectsRateLimit) {
  for (int k = 0; k < 500; ++k) {
    const double phase = 0.1 * k;
    const double rate = rate_for(std::sin(7 * phase) * 4, at(std::fmod(phase, 3), phase),
                                 at(0.3 * std::sin(3 * phase), 2 * phase));
    ASSERT_LE(std::abs(rate), 0.2 + 1e-12);
  }
}

}  // namespace
}  // namespace stillkite
