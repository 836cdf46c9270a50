#include "navigation/station_attitude.hpp"

#include <gtest/gtest.h>

#include "geometry/euler.hpp"

namespace stillkite {
namespace {

Eigen::Quaterniond attitude(double yaw_rad, double pitch_rad = 0.3, double roll_rad = -0.2) {
  return to_quaternion({.yaw_rad = yaw_rad, .pitch_rad = pitch_rad, .roll_rad = roll_rad});
}

void expect_same(const Eigen::Quaterniond& actual, const Eigen::Quaterniond& expected) {
  EXPECT_LT(actual.angularDistance(expected), 1e-12);
}

TEST(StationAttitude, InitialYawIsZeroThenIntegratesEstimate) {
  StationAttitude station;
  expect_same(station.step(attitude(2.0), std::nullopt), attitude(0.0));
  expect_same(station.step(attitude(2.5, 0.1, 0.4), std::nullopt), attitude(0.5, 0.1, 0.4));
  expect_same(station.step(attitude(-3.0), std::nullopt), attitude(-5.0));
}

// Tilt and rotation follow the sensor; its absolute heading is ignored.
TEST(StationAttitude, FollowsSensorAttitude) {
  StationAttitude station;
  expect_same(station.step(attitude(2.0), attitude(-1.0, 0.31)), attitude(0.0, 0.31));
  expect_same(station.step(attitude(2.0), attitude(-0.9, 0.32)), attitude(0.1, 0.32));
}

TEST(StationAttitude, IntegratesEstimateBetweenReadings) {
  StationAttitude station;
  (void)station.step(attitude(2.0), attitude(-1.0));
  expect_same(station.step(attitude(2.2), std::nullopt), attitude(0.2));
  expect_same(station.step(attitude(2.4), std::nullopt), attitude(0.4));
  // the sensor corrects the drift of the estimate
  expect_same(station.step(attitude(2.6), attitude(-0.5)), attitude(0.5));
}

TEST(StationAttitude, LateFirstReadingKeepsYaw) {
  StationAttitude station;
  (void)station.step(attitude(2.0), std::nullopt);
  expect_same(station.step(attitude(2.3), attitude(1.0, 0.31)), attitude(0.3, 0.31));
}

}  // namespace
}  // namespace stillkite
