#include "io/dataset/gyro_check.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/angle.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {
namespace {

using Eigen::Vector3d;

Vector3d rate_rad_s(double t_s) {
  return {0.2 * std::sin(1.3 * t_s), 0.15 * std::cos(2.1 * t_s + 1), 0.3 * std::sin(0.7 * t_s + 2)};
}

struct Flight {
  TimeSeries<Vector3d> gyro;
  std::vector<SeenTurn> seen;
};

std::string doubt(const Flight& flight) {
  return doubt_of_gyro(flight.gyro, flight.seen).value_or("");
}

bool tells(const Flight& flight, std::string_view what) {
  return doubt(flight).find(what) != std::string::npos;
}

// Ten seconds; images err by 1 mrad a frame.
Flight flight(double gyro_starts_s = 0) {
  std::mt19937 random(1);
  std::normal_distribution<double> error(0, 1e-3);
  Flight out;
  for (int i = 0; i <= 2000; ++i) {
    out.gyro.stamps.push_back(from_seconds(0.005 * i + gyro_starts_s));
    out.gyro.values.push_back(rate_rad_s(0.005 * i - 0.0025));
  }
  for (int i = 1; i < 250; ++i) {
    out.seen.push_back({from_seconds(0.04 * i - 0.04), from_seconds(0.04 * i),
                        0.04 * rate_rad_s(0.04 * i - 0.02) +
                            Vector3d(error(random), error(random), error(random))});
  }
  return out;
}

TEST(GyroCheck, NothingIsSaidWhereBothTurnAlike) {
  const Flight f = flight();
  EXPECT_EQ(doubt(f), "");
}

TEST(GyroCheck, DegreesAreTold) {
  Flight f = flight();
  for (Vector3d& rate : f.gyro.values) rate /= kDegree;
  EXPECT_TRUE(tells(f, "taken for deg/s")) << doubt(f);
}

TEST(GyroCheck, OtherAxesAreTold) {
  Flight f = flight();
  const Eigen::Quaterniond turn = so3_exp({0, 0, -90 * kDegree});
  for (Vector3d& rate : f.gyro.values) rate = turn * rate;
  EXPECT_TRUE(tells(f, "turned by 90 deg about (")) << doubt(f);
  for (Vector3d& rate : f.gyro.values) rate = -(turn.conjugate() * rate);
  EXPECT_TRUE(tells(f, "signs")) << doubt(f);
}

TEST(GyroCheck, AnotherClockIsTold) {
  const Flight ahead = flight(0.8);
  EXPECT_TRUE(tells(ahead, "0.80 s ahead")) << doubt(ahead);
  const Flight behind = flight(-0.8);
  EXPECT_TRUE(tells(behind, "0.80 s behind")) << doubt(behind);
}

TEST(GyroCheck, AGyroscopeThatTellsNothingIsTold) {
  Flight f = flight();
  for (Vector3d& rate : f.gyro.values) rate.setConstant(1e-4);
  EXPECT_TRUE(tells(f, "tells nothing")) << doubt(f);
}

TEST(GyroCheck, NothingIsSaidOfWhatHardlyTurns) {
  Flight f = flight();
  for (SeenTurn& turn : f.seen) turn.in_body_rad *= 0.05;
  for (Vector3d& rate : f.gyro.values) rate *= -0.05;
  EXPECT_EQ(doubt(f), "");
}

// Nor where the images turn anyhow.
TEST(GyroCheck, NothingIsSaidOfWhatNothingExplains) {
  Flight f = flight();
  std::mt19937 random(1);
  std::normal_distribution<double> any(0, 0.02);
  for (SeenTurn& turn : f.seen) turn.in_body_rad = {any(random), any(random), any(random)};
  EXPECT_EQ(doubt(f), "");
}

}  // namespace
}  // namespace stillkite
