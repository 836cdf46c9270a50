#include "evaluation/yaw_settling.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace stillkite {
namespace {

struct Sampled {
  std::vector<double> t_s;
  std::vector<double> error_rad;

  [[nodiscard]] std::optional<double> settling(double from_s, double until_s) const {
    return settling_time_s({t_s, error_rad}, from_s, until_s, 0.1);
  }
};

// Step at t = 2 s, then exp(-(t - 2)); 100 Hz.
Sampled decay() {
  Sampled samples;
  for (int i = 0; i < 1000; ++i) {
    samples.t_s.push_back(0.01 * i);
    samples.error_rad.push_back(i < 200 ? 0.0 : std::exp(2 - 0.01 * i));
  }
  return samples;
}

TEST(YawSettling, ExponentialDecaySettlesAtItsLogarithm) {
  const auto time_s = decay().settling(2, 10);
  ASSERT_TRUE(time_s);
  EXPECT_NEAR(*time_s, std::log(10.0), 0.01);
}

TEST(YawSettling, CountsFromTheLastEntryIntoTheLimit) {
  Sampled errors = decay();
  errors.error_rad[700] = -0.11;
  EXPECT_NEAR(*errors.settling(2, 10), 5.01, 1e-9);
  // samples after `until_s` are ignored
  EXPECT_NEAR(*errors.settling(2, 7), std::log(10.0), 0.01);
}

TEST(YawSettling, ReturnsNothingIfTheEndExceedsTheLimit) {
  EXPECT_FALSE(decay().settling(2, 4));
  EXPECT_FALSE(decay().settling(20, 30));
  EXPECT_FALSE(Sampled{}.settling(0, 1));
}

TEST(YawSettling, IsZeroIfAlwaysWithinTheLimit) {
  EXPECT_EQ(decay().settling(0, 2), 0.0);
}

}  // namespace
}  // namespace stillkite
