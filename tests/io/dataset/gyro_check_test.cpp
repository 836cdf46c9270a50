#include "io/dataset/gyro_check.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
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
  std::vector<ObservedRotation> observed;
};

std::string message(const Flight& flight) {
  return gyro_inconsistency(flight.gyro, flight.observed).value_or("");
}

bool mentions(const Flight& flight, std::string_view text) {
  return message(flight).find(text) != std::string::npos;
}

// 10 s; image noise of 1 mrad per frame and axis.
Flight flight(double gyro_starts_s = 0) {
  std::mt19937 random(1);
  std::normal_distribution<double> error(0, 1e-3);
  Flight out;
  for (int i = 0; i <= 2000; ++i) {
    out.gyro.stamps.push_back(from_seconds(0.005 * i + gyro_starts_s));
    out.gyro.values.push_back(rate_rad_s(0.005 * i - 0.0025));
  }
  for (int i = 1; i < 250; ++i) {
    out.observed.push_back({from_seconds(0.04 * i - 0.04), from_seconds(0.04 * i),
                            0.04 * rate_rad_s(0.04 * i - 0.02) +
                                Vector3d(error(random), error(random), error(random))});
  }
  return out;
}

TEST(GyroCheck, AcceptsConsistentRotations) {
  const Flight f = flight();
  EXPECT_EQ(message(f), "");
}

// Readings are missing for 1 s of every 3 s.
Flight with_gaps(Flight f) {
  TimeSeries<Vector3d> kept{.stamps = {}, .values = {}, .max_gap_s = 0.02};
  for (std::size_t i = 0; i < f.gyro.stamps.size(); ++i) {
    if (std::fmod(to_seconds(f.gyro.stamps[i]), 3) > 2) continue;
    kept.stamps.push_back(f.gyro.stamps[i]);
    kept.values.push_back(f.gyro.values[i]);
  }
  f.gyro = kept;
  return f;
}

TEST(GyroCheck, AcceptsConsistentRotationsWithGaps) {
  EXPECT_EQ(message(with_gaps(flight())), "");
}

// A straight line over a gap is no reading.
TEST(GyroCheck, DetectsClockOffsetWithGaps) {
  const Flight f = with_gaps(flight(0.06));
  EXPECT_TRUE(mentions(f, "0.06 s ahead")) << message(f);
}

TEST(GyroCheck, DetectsDegreesInsteadOfRadians) {
  Flight f = flight();
  for (Vector3d& rate : f.gyro.values) rate /= kDegree;
  EXPECT_TRUE(mentions(f, "deg/s instead of rad/s")) << message(f);
}

TEST(GyroCheck, DetectsRotatedAndInvertedAxes) {
  Flight f = flight();
  const Eigen::Quaterniond rotation = so3_exp({0, 0, -90 * kDegree});
  for (Vector3d& rate : f.gyro.values) rate = rotation * rate;
  EXPECT_TRUE(mentions(f, "rotated by 90 deg about (")) << message(f);
  for (Vector3d& rate : f.gyro.values) rate = -(rotation.conjugate() * rate);
  EXPECT_TRUE(mentions(f, "inverted")) << message(f);
}

TEST(GyroCheck, DetectsClockOffset) {
  const Flight ahead = flight(0.8);
  EXPECT_TRUE(mentions(ahead, "0.80 s ahead")) << message(ahead);
  const Flight behind = flight(-0.8);
  EXPECT_TRUE(mentions(behind, "0.80 s behind")) << message(behind);
}

TEST(GyroCheck, DetectsClockOffsetOf60Milliseconds) {
  const Flight ahead = flight(0.06);
  EXPECT_TRUE(mentions(ahead, "0.06 s ahead of the images (add -0.0")) << message(ahead);
  const Flight behind = flight(-0.06);
  EXPECT_TRUE(mentions(behind, "0.06 s behind the images (add +0.0")) << message(behind);
}

// Noise of a frame is three times its rotation, in both sensors correct; the gyroscope has a bias.
TEST(GyroCheck, AcceptsCorrectGyroscopeAt240FramesPerSecond) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> error(0, 3e-3);
    Flight f = flight();
    f.observed.clear();
    for (Vector3d& rate : f.gyro.values) rate += Vector3d(0.05, -0.08, 0.03);
    for (int i = 1; i < 2390; ++i) {
      f.observed.push_back({from_seconds((i - 1) / 240.0), from_seconds(i / 240.0),
                            rate_rad_s((i - 0.5) / 240) / 240 +
                                Vector3d(error(random), error(random), error(random))});
    }
    EXPECT_EQ(message(f), "") << seed;
  }
}

// Yaw of 0.8 Hz repeats after 1.25 s.
TEST(GyroCheck, FindsSmallestOffsetOfAPeriodicMotion) {
  Flight f = flight();
  for (std::size_t i = 0; i < f.gyro.stamps.size(); ++i) {
    f.gyro.values[i] = {0, 0, std::cos(1.6 * std::numbers::pi * 0.005 * static_cast<double>(i))};
    f.gyro.stamps[i].ns += 60'000'000;
  }
  for (std::size_t i = 0; i < f.observed.size(); ++i) {
    const double t_s = 0.04 * (static_cast<double>(i) + 0.5);
    f.observed[i].rotation_in_body_rad = {0, 0, 0.04 * std::cos(1.6 * std::numbers::pi * t_s)};
  }
  EXPECT_TRUE(mentions(f, "add -0.060 to time_offset_s")) << message(f);
}

// The interpolation of 5 readings per second has a kink at each reading: the best offset is that to
// the nearest frame, 24 ms.
TEST(GyroCheck, ALowRateIsNoClockOffset) {
  const auto rate = [](double t_s) {
    return Vector3d(0.1 * std::sin(4.1 * t_s), 0.07 * std::sin(2.9 * t_s + 1),
                    0.5 * std::sin(0.8 * std::numbers::pi * t_s));
  };
  Flight f;
  for (int i = 0; i <= 60; ++i) {
    f.gyro.stamps.push_back(from_seconds(0.2 * i));
    f.gyro.values.push_back(rate(0.2 * i));
  }
  for (int i = 1; i < 360; ++i) {
    f.observed.push_back(
        {from_seconds((i - 1) / 30.0), from_seconds(i / 30.0), rate((i - 0.5) / 30) / 30});
  }
  EXPECT_EQ(message(f), "");
}

TEST(GyroCheck, DetectsGyroscopeWithoutSignal) {
  Flight f = flight();
  for (Vector3d& rate : f.gyro.values) rate.setConstant(1e-4);
  EXPECT_TRUE(mentions(f, "measures no rotation")) << message(f);
}

// Image rotations that are wrong themselves, by a prior of the gyroscope: no hypothesis explains
// them.
TEST(GyroCheck, ReportsAGyroscopeFasterThanTheImages) {
  Flight f = flight();
  for (Vector3d& rate : f.gyro.values) rate *= 180 / std::numbers::pi;
  std::mt19937 random(3);
  std::normal_distribution<double> error(0, 0.02);
  for (ObservedRotation& rotation : f.observed) {
    rotation.rotation_in_body_rad += Vector3d(error(random), error(random), error(random));
  }
  EXPECT_TRUE(mentions(f, "give the angular rates in rad/s")) << message(f);
}

TEST(GyroCheck, IgnoresSmallRotations) {
  Flight f = flight();
  for (ObservedRotation& rotation : f.observed) rotation.rotation_in_body_rad *= 0.02;
  for (Vector3d& rate : f.gyro.values) rate *= -0.02;
  EXPECT_EQ(message(f), "");
}

// Image rotations are noise.
TEST(GyroCheck, ReportsNothingWithoutAnExplanation) {
  Flight f = flight();
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, 0.02);
  for (ObservedRotation& rotation : f.observed)
    rotation.rotation_in_body_rad = {noise(random), noise(random), noise(random)};
  EXPECT_EQ(message(f), "");
}

}  // namespace
}  // namespace stillkite
