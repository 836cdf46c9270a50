#include "evaluation/mean_interval.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace stillkite {
namespace {

constexpr double kTrueMean = 0.7;

// AR(1): x_i - mean = correlation (x_i-1 - mean) + noise, from the stationary distribution.
std::vector<double> correlated_series(std::mt19937_64& random, int count, double correlation) {
  std::normal_distribution<double> normal;
  double deviation = normal(random) / std::sqrt(1 - correlation * correlation);
  std::vector<double> series;
  series.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    series.push_back(kTrueMean + deviation);
    deviation = correlation * deviation + normal(random);
  }
  return series;
}

struct Coverage {
  double reliable = 0;  // share of the series
  double covered = 0;   // share of the reliable series whose interval contains the true mean
  double covered_if_independent = 0;
};

Coverage coverage(double correlation) {
  constexpr int kSeries = 2000;
  std::mt19937_64 random(41);
  int reliable = 0;
  int covered = 0;
  int covered_if_independent = 0;
  const auto contains_mean = [](const MeanInterval& interval) {
    return interval.low <= kTrueMean && kTrueMean <= interval.high;
  };
  for (int i = 0; i < kSeries; ++i) {
    const std::vector<double> series = correlated_series(random, 1500, correlation);
    const MeanInterval interval = correlated_mean_interval(series).value();
    covered_if_independent += contains_mean(independent_mean_interval(series).value()) ? 1 : 0;
    if (!interval.is_reliable) continue;
    ++reliable;
    covered += contains_mean(interval) ? 1 : 0;
  }
  return {.reliable = 1.0 * reliable / kSeries,
          .covered = 1.0 * covered / reliable,
          .covered_if_independent = 1.0 * covered_if_independent / kSeries};
}

TEST(MeanInterval, FiveSamplesMatchHandCalculation) {
  const std::vector<double> samples{1, 2, 3, 4, 5};
  const auto interval = independent_mean_interval(samples);
  ASSERT_TRUE(interval);
  EXPECT_EQ(interval->samples, 5);
  EXPECT_DOUBLE_EQ(interval->mean, 3);
  EXPECT_NEAR(interval->high, 3 + 2.776445 * std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(interval->low, 3 - 2.776445 * std::sqrt(0.5), 1e-6);
}

// Coverage of 0.95 over 2000 series: three standard errors are 0.015.
TEST(MeanInterval, HasNominalCoverageForWhiteNoise) {
  const Coverage found = coverage(0);
  EXPECT_NEAR(found.covered, 0.95, 0.015);
  EXPECT_NEAR(found.covered_if_independent, 0.95, 0.015);
  EXPECT_NEAR(found.reliable, 0.95, 0.02);
}

TEST(MeanInterval, HasNominalCoverageForCorrelatedNoise) {
  for (const double correlation : {0.5, 0.9}) {
    const Coverage found = coverage(correlation);
    EXPECT_NEAR(found.covered, 0.95, 0.02) << correlation;
    EXPECT_GT(found.reliable, 0.9) << correlation;
  }
  EXPECT_LT(coverage(0.9).covered_if_independent, 0.4) << "batch means have no effect";
}

// Correlation over 40 of 1500 samples: batches slightly too short, barely detectable.
TEST(MeanInterval, HasNearNominalCoverageForLongCorrelation) {
  EXPECT_GT(coverage(0.95).covered, 0.91);
}

TEST(MeanInterval, RandomWalkIsNotReliable) {
  std::mt19937_64 random(42);
  std::normal_distribution<double> normal;
  int reliable = 0;
  for (int i = 0; i < 200; ++i) {
    std::vector<double> walk{0};
    walk.reserve(1500);
    while (walk.size() < 1500) walk.push_back(walk.back() + normal(random));
    reliable += correlated_mean_interval(walk)->is_reliable ? 1 : 0;
  }
  EXPECT_LT(reliable, 10);
}

TEST(MeanInterval, ConstantSamplesGiveZeroWidth) {
  const auto interval = correlated_mean_interval(std::vector<double>(23, -2.5));
  ASSERT_TRUE(interval);
  EXPECT_EQ(interval->samples, 23);
  EXPECT_NEAR(interval->low, -2.5, 1e-12);
  EXPECT_NEAR(interval->high, -2.5, 1e-12);
  EXPECT_TRUE(differs_from_zero(*interval));
  EXPECT_FALSE(differs_from_zero({.samples = 9, .mean = 1, .low = -1, .high = 3}));
  EXPECT_FALSE(
      differs_from_zero({.samples = 9, .mean = 2, .low = 1, .high = 3, .is_reliable = false}));
}

TEST(MeanInterval, ReturnsNothingForTooFewSamples) {
  EXPECT_FALSE(independent_mean_interval(std::vector<double>{1}));
  EXPECT_FALSE(correlated_mean_interval(std::vector<double>(19, 1)));
}

TEST(StudentT, MatchesClosedFormForOneAndTwoDegreesOfFreedom) {
  for (const double t : {0.0, 0.3, 1.0, 4.0, 50.0}) {
    EXPECT_NEAR(student_t_probability(t, 1), 2 / std::numbers::pi * std::atan(t), 1e-14);
    EXPECT_NEAR(student_t_probability(t, 2), t / std::sqrt(2 + t * t), 1e-14);
  }
  EXPECT_NEAR(student_t_two_sided_quantile(0.95, 1), std::tan(0.475 * std::numbers::pi), 1e-9);
  EXPECT_NEAR(student_t_two_sided_quantile(0.95, 2), 0.95 * std::sqrt(2 / (1 - 0.95 * 0.95)), 1e-9);
}

// Abramowitz & Stegun, table 26.10.
TEST(StudentT, MatchesTables) {
  EXPECT_NEAR(student_t_two_sided_quantile(0.95, 4), 2.776, 5e-4);
  EXPECT_NEAR(student_t_two_sided_quantile(0.95, 9), 2.262, 5e-4);
  EXPECT_NEAR(student_t_two_sided_quantile(0.99, 7), 3.499, 5e-4);
  EXPECT_NEAR(student_t_two_sided_quantile(0.95, 120), 1.980, 5e-4);
}

TEST(StudentT, ManyDegreesOfFreedomApproachNormal) {
  EXPECT_NEAR(student_t_probability(1.959964, 200000), 0.95, 1e-5);
}

}  // namespace
}  // namespace stillkite
