#include <gtest/gtest.h>

#include <cmath>

#include "simulation/flight/clock.hpp"

namespace stillkite {
namespace {

std::vector<Timestamp> every(double interval_s, int count) {
  std::vector<Timestamp> stamps;
  for (int k = 0; k < count; ++k) stamps.push_back(from_seconds(k * interval_s));
  return stamps;
}

struct Moments {
  double mean = 0;
  double deviation = 0;
};

Moments latency_moments_s(const std::vector<Timestamp>& exposures,
                          const std::vector<Timestamp>& stamps) {
  double sum = 0;
  double square = 0;
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    const double latency_s = seconds_between(exposures[k], stamps[k]);
    sum += latency_s;
    square += latency_s * latency_s;
  }
  const auto count = static_cast<double>(stamps.size());
  return {sum / count, std::sqrt(square / count - sum * sum / (count * count))};
}

TEST(Clock, IsExactByDefault) {
  const std::vector<Timestamp> exposures = every(1.0 / 30, 100);
  EXPECT_EQ(image_stamps({}, exposures, 1), exposures);
  EXPECT_EQ(imu_stamp({}, exposures[7]), exposures[7]);
}

// Exponential distribution: standard deviation = mean; relative error of both about 1 / sqrt(n).
TEST(Clock, JitterIsOneSidedWithConfiguredMeanAndDeviation) {
  const std::vector<Timestamp> exposures = every(1, 20000);
  const std::vector<Timestamp> stamps =
      image_stamps({.image_delay_s = 0.04, .jitter_s = 0.005}, exposures, 3);
  const Moments latency_s = latency_moments_s(exposures, stamps);
  EXPECT_NEAR(latency_s.mean, 0.045, 2e-4);
  EXPECT_NEAR(latency_s.deviation, 0.005, 2e-4);
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    EXPECT_GE(seconds_between(exposures[k], stamps[k]), 0.04 - 1e-9);
  }
}

TEST(Clock, ImagesArriveInOrder) {
  const std::vector<Timestamp> stamps =
      image_stamps({.jitter_s = 0.2, .rounding_s = 0.004}, every(1.0 / 30, 2000), 3);
  for (std::size_t k = 1; k < stamps.size(); ++k) {
    EXPECT_GE(stamps[k].ns - stamps[k - 1].ns, 4'000'000);
  }
}

// Error of rounding: uniform within half a step, deviation step / sqrt(12).
TEST(Clock, RoundsStampsToResolution) {
  const std::vector<Timestamp> exposures = every(0.041234567, 5000);
  const std::vector<Timestamp> stamps = image_stamps({.rounding_s = 1e-3}, exposures, 3);
  for (const Timestamp stamp : stamps) EXPECT_EQ(stamp.ns % 1'000'000, 0);
  const Moments error_s = latency_moments_s(exposures, stamps);
  EXPECT_NEAR(error_s.mean, 0, 2e-5);
  EXPECT_NEAR(error_s.deviation, 1e-3 / std::sqrt(12.0), 1e-5);
  EXPECT_EQ(imu_stamp({.rounding_s = 1e-3}, {1'499'999}).ns, 1'000'000);
  EXPECT_EQ(imu_stamp({.rounding_s = 1e-3}, {1'500'001}).ns, 2'000'000);
}

TEST(Clock, ImuStampHasOffsetAndSkew) {
  const Timestamp stamp = imu_stamp({.imu_offset_s = -0.02, .imu_skew_ppm = 50}, from_seconds(100));
  EXPECT_EQ(stamp.ns, 100'000'000'000 - 20'000'000 + 5'000'000);
}

}  // namespace
}  // namespace stillkite
