#include "stabilization/tether_rates.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace stillkite {
namespace {

using std::numbers::pi;

constexpr double kDamped_m = 0.5;
constexpr double kZenithRadius_m = 2;

class RandomTether {
 public:
  TetherState state() { return {in(0.5, 20), in(0, pi), in(-4, 4)}; }
  Eigen::Vector3d velocity() { return {in(-1, 1), in(-1, 1), in(-1, 1)}; }
  double in(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }

 private:
  std::mt19937 random_{7};
};

TEST(TetherRates, VelocityIsTheDerivativeOfThePosition) {
  RandomTether random;
  for (int k = 0; k < 1000; ++k) {
    const TetherState t = random.state();
    const TetherCommand c{random.in(-1, 1), random.in(-1, 1), random.in(-1, 1), 3};
    const auto later = [&](double h) {
      return position_in_station({t.length_m + h * c.length_rate_m_s,
                                  t.elevation_rad + h * c.elevation_rate_rad_s,
                                  t.azimuth_rad + h * c.azimuth_rate_rad_s});
    };
    const Eigen::Vector3d numeric = (later(1e-6) - later(-1e-6)) / 2e-6;
    ASSERT_LT((velocity_in_station_m_s(t, c) - numeric).norm(), 1e-7);
  }
}

TEST(TetherRates, InverseIsExactAwayFromTheZenith) {
  RandomTether random;
  for (int k = 0; k < 1000; ++k) {
    const TetherState t = random.state();
    if (std::abs(t.length_m * std::cos(t.elevation_rad)) < kZenithRadius_m) continue;
    const Eigen::Vector3d v = random.velocity();
    const TetherCommand c = rates_for_velocity(t, v, kDamped_m, {kZenithRadius_m, 0.1});
    ASSERT_LT((velocity_in_station_m_s(t, c) - v).norm(), 1e-12);
  }
}

TEST(TetherRates, RatesNearZenithAreBoundedAndReduceTheError) {
  RandomTether random;
  for (int k = 0; k < 20000; ++k) {
    TetherState t = random.state();
    t.elevation_rad = pi / 2 + random.in(-1, 1) * kZenithRadius_m / t.length_m;
    const Eigen::Vector3d v = random.velocity();
    const TetherCommand c = rates_for_velocity(t, v, kDamped_m, {kZenithRadius_m, 0});
    ASSERT_LE(std::abs(c.azimuth_rate_rad_s), v.norm() / kZenithRadius_m + 1e-12);
    ASSERT_GE(velocity_in_station_m_s(t, c).dot(v), -1e-12);
  }
}

TEST(TetherRates, ZenithAzimuthRateFadesWithSquaredLever) {
  const auto rate_rad_s = [](double lever_m) {
    const TetherState t{5, std::acos(lever_m / 5), 0.7};
    return rates_for_velocity(t, Eigen::Vector3d::Zero(), kDamped_m, {kZenithRadius_m, 0.2})
        .azimuth_rate_rad_s;
  };
  EXPECT_NEAR(rate_rad_s(0), 0.2, 1e-9);
  EXPECT_NEAR(rate_rad_s(1), 0.15, 1e-9);
  EXPECT_NEAR(rate_rad_s(-1), 0.15, 1e-9);
  EXPECT_NEAR(rate_rad_s(2), 0, 1e-9);
  EXPECT_EQ(rate_rad_s(3), 0);
}

TEST(TetherRates, RatesRespectLimitsAndEnds) {
  RandomTether random;
  const VehicleLimits limits;
  for (int k = 0; k < 10000; ++k) {
    const TetherState t{random.in(0, 21), random.in(-0.2, pi + 0.2), random.in(-9, 9)};
    const TetherCommand c = within_limits(
        limits, t, {random.in(-2, 2), random.in(-2, 2), random.in(-2, 2), random.in(-2, 2)});
    ASSERT_LE(std::abs(c.length_rate_m_s), 0.3);
    ASSERT_LE(std::abs(c.elevation_rate_rad_s), 0.25);
    ASSERT_LE(std::abs(c.azimuth_rate_rad_s), 0.2);
    ASSERT_LE(std::abs(c.yaw_rate_rad_s), 0.4);
    ASSERT_TRUE(!(t.length_m >= 20) || c.length_rate_m_s <= 0);
    ASSERT_TRUE(!(t.length_m <= limits.min_length_m) || c.length_rate_m_s >= 0);
    ASSERT_TRUE(!(t.elevation_rad <= 0) || c.elevation_rate_rad_s >= 0);
    ASSERT_TRUE(!(t.elevation_rad >= pi) || c.elevation_rate_rad_s <= 0);
  }
}

TEST(TetherRates, LaggingDroneStopsBeforeTheEnd) {
  double length_m = 18, rate_m_s = 0;
  for (int k = 0; k < 4000; ++k) {
    const TetherCommand c = within_limits({}, {length_m, 1, 0}, {.length_rate_m_s = 1});
    rate_m_s += 0.01 / 0.5 * (c.length_rate_m_s - rate_m_s);
    length_m += 0.01 * rate_m_s;
    ASSERT_LE(length_m, 20 + 1e-9);
  }
  EXPECT_NEAR(length_m, 20, 1e-3);
}

}  // namespace
}  // namespace stillkite
