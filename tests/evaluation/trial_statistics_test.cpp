#include "evaluation/trial_statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace stillkite {
namespace {

TEST(TrialStatistics, UniformSamplesMatchClosedForm) {
  // d uniform in [-2, 2]: mean |d| = 1, standard deviation of d = 2 / sqrt(3)
  std::vector<double> d;
  d.reserve(40001);
  for (int i = 0; i <= 40000; ++i) d.push_back(-2 + 1e-4 * i);
  const auto found = signed_statistics(d);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->mean, 1, 1e-4);
  EXPECT_NEAR(found->deviation, 2 / std::sqrt(3), 1e-4);
  EXPECT_DOUBLE_EQ(found->max, 2);
  EXPECT_EQ(found->samples, 40001);
}

TEST(TrialStatistics, OffsetAffectsMeanNotDeviation) {
  const auto found = signed_statistics(std::vector<double>{-0.3, -0.3, -0.3});
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->mean, 0.3, 1e-15);
  EXPECT_NEAR(found->deviation, 0, 1e-15);
}

TEST(TrialStatistics, ReturnsNothingWithoutSamples) {
  EXPECT_FALSE(signed_statistics({}));
}

}  // namespace
}  // namespace stillkite
