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

TEST(StationAttitude, TheFirstHeadingIsZeroAndTheEstimateTurnsItOn) {
  StationAttitude station;
  expect_same(station.step(attitude(2.0), std::nullopt), attitude(0.0));
  expect_same(station.step(attitude(2.5, 0.1, 0.4), std::nullopt), attitude(0.5, 0.1, 0.4));
  expect_same(station.step(attitude(-3.0), std::nullopt), attitude(-5.0));
}

// Tilt and turns are the sensor's, whatever its heading is called.
TEST(StationAttitude, ASensorsReadingIsTaken) {
  StationAttitude station;
  expect_same(station.step(attitude(2.0), attitude(-1.0, 0.31)), attitude(0.0, 0.31));
  expect_same(station.step(attitude(2.0), attitude(-0.9, 0.32)), attitude(0.1, 0.32));
}

TEST(StationAttitude, BetweenReadingsTheEstimateGoesOn) {
  StationAttitude station;
  (void)station.step(attitude(2.0), attitude(-1.0));
  expect_same(station.step(attitude(2.2), std::nullopt), attitude(0.2));
  expect_same(station.step(attitude(2.4), std::nullopt), attitude(0.4));
  // the estimate had drifted: the sensor knows
  expect_same(station.step(attitude(2.6), attitude(-0.5)), attitude(0.5));
}

TEST(StationAttitude, ALateFirstReadingDoesNotTurnTheStation) {
  StationAttitude station;
  (void)station.step(attitude(2.0), std::nullopt);
  expect_same(station.step(attitude(2.3), attitude(1.0, 0.31)), attitude(0.3, 0.31));
}

}  // namespace
}  // namespace stillkite
