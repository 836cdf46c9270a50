#include "io/dataset/interpolation_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace stillkite {
namespace {

using Eigen::Vector3d;

constexpr int kSteps = 40;  // of the signal between two readings
constexpr int kReadings = 2000;
constexpr double kReadingInterval_s = 0.1;

// Random walk of spectral density 1, and its readings.
struct Walk {
  std::vector<Vector3d> signal;
  TimeSeries<Vector3d> readings;
};

Walk walk() {
  std::mt19937 random(1);
  std::normal_distribution<> step(0, std::sqrt(kReadingInterval_s / kSteps));
  Walk out;
  Vector3d value = Vector3d::Zero();
  for (int i = 0; i <= kSteps * kReadings; ++i) {
    out.signal.push_back(value);
    if (i % kSteps == 0) {
      out.readings.stamps.push_back(from_seconds(kReadingInterval_s / kSteps * i));
      out.readings.values.push_back(value);
    }
    value += Vector3d(step(random), step(random), step(random));
  }
  return out;
}

// Errors of the interpolated signal, of a value and of its integral over an interval.
TEST(InterpolationNoise, IsTheErrorOfAnInterpolatedRandomWalk) {
  const Walk w = walk();
  double value_variance = 0, integral_variance = 0;
  for (int i = 0; i < kReadings; ++i) {
    Vector3d integral = Vector3d::Zero();
    for (int k = 0; k < kSteps; ++k) {
      const double ratio = static_cast<double>(k) / kSteps;
      const Vector3d error = w.signal[kSteps * i + k] - (1 - ratio) * w.readings.values[i] -
                             ratio * w.readings.values[i + 1];
      value_variance += error.squaredNorm() / (3.0 * kSteps * kReadings);
      integral += kReadingInterval_s / kSteps * error;
    }
    integral_variance += integral.squaredNorm() / (3.0 * kReadings);
  }
  const InterpolationNoise noise = interpolation_noise(w.readings, 0);
  EXPECT_NEAR(noise.sigma * noise.sigma / value_variance, 1, 0.1);
  EXPECT_NEAR(noise.density * noise.density * kReadingInterval_s / integral_variance, 1, 0.1);
}

TEST(InterpolationNoise, IsZeroForLinesForTheReadingsOwnNoiseAndAtHighRates) {
  constexpr double kDensity = 0.01;
  std::mt19937 random(2);
  std::normal_distribution<> error(0, kDensity / std::sqrt(kReadingInterval_s));
  TimeSeries<Vector3d> line, noisy;
  for (int i = 0; i < kReadings; ++i) {
    line.stamps.push_back(from_seconds(kReadingInterval_s * i));
    line.values.push_back(Vector3d::Constant(i));
    noisy.values.emplace_back(error(random), error(random), error(random));
  }
  noisy.stamps = line.stamps;
  EXPECT_NEAR(interpolation_noise(line, 0).density, 0, 1e-9);
  EXPECT_LT(interpolation_noise(noisy, kDensity).density, 0.2 * kDensity);
  TimeSeries<Vector3d> fast = walk().readings;
  for (Timestamp& stamp : fast.stamps) stamp.ns /= 10;
  EXPECT_EQ(interpolation_noise(fast, 0).density, 0);
}

}  // namespace
}  // namespace stillkite
