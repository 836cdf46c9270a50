#include "evaluation/median_interval.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

namespace stillkite {
namespace {

// n, n - 1, ..., 1
std::vector<double> descending(int n) {
  std::vector<double> values(static_cast<std::size_t>(n));
  std::iota(values.rbegin(), values.rend(), 1.0);
  return values;
}

TEST(MedianInterval, AveragesTheMiddleOfAnEvenNumberOfSamples) {
  EXPECT_EQ(median_interval(std::vector{3.0, 1.0, 8.0})->median, 3);
  EXPECT_EQ(median_interval(std::vector{3.0, 1.0, 8.0, 4.0})->median, 3.5);
  EXPECT_FALSE(median_interval({}));
}

// Sums of binomial coefficients: 2 / 2^6 = 0.031, 2 / 2^5 = 0.063; 2 (1 + 9) / 2^9 = 0.039;
// 2 (1 + 8) / 2^8 = 0.070; 2 (1 + 15 + 105 + 455) / 2^15 = 0.035.
TEST(MedianInterval, HasTheTabulatedRanks) {
  EXPECT_FALSE(median_interval(descending(5))->interval);
  const auto expect_bounds = [](int n, double low, double high) {
    const auto found = median_interval(descending(n));
    ASSERT_TRUE(found->interval) << n;
    EXPECT_EQ(found->samples, n);
    EXPECT_EQ(found->interval->low, low) << n;
    EXPECT_EQ(found->interval->high, high) << n;
  };
  expect_bounds(6, 1, 6);
  expect_bounds(8, 1, 8);
  expect_bounds(9, 2, 8);
  expect_bounds(15, 4, 12);
  expect_bounds(20, 6, 15);
}

// Normal approximation: ranks (n + 1) / 2 -+ 1.96 sqrt(n) / 2.
TEST(MedianInterval, HasTheRanksOfTheNormalApproximationForManySamples) {
  const auto found = median_interval(descending(10000));
  EXPECT_NEAR(found->interval->low, 5000.5 - 98, 1);
  EXPECT_NEAR(found->interval->high, 5000.5 + 98, 1);
}

TEST(NearestRankQuantile, IsTheSmallestSampleWithTheRatioBelow) {
  EXPECT_EQ(nearest_rank_quantile(descending(10), 0.9), 9);
  EXPECT_EQ(nearest_rank_quantile(descending(11), 0.9), 10);
  EXPECT_EQ(nearest_rank_quantile(descending(10), 1), 10);
  EXPECT_EQ(nearest_rank_quantile(std::vector{7.0}, 0.01), 7);
  EXPECT_FALSE(nearest_rank_quantile({}, 0.5));
}

}  // namespace
}  // namespace stillkite
