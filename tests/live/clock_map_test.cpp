#include "live/clock/clock_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

namespace stillkite {
namespace {

using Delay_s = std::function<double(std::mt19937&)>;

constexpr double kPeriod_s = 1.0 / 30, kSmallestDelay_s = 0.02;
constexpr std::int64_t kSenderEpoch_ns = 987'654'321'000'000;
constexpr std::int64_t kLocalEpoch_ns = 12'345'678'900;

struct Sample {
  std::int64_t sender_ns = 0;
  Timestamp sent, arrival;  // local clock
};

// Frame k of a sender whose clock runs slower by `skew`.
Sample sample_at(int k, double skew, double delay_s) {
  const double t_s = k * kPeriod_s;
  const Timestamp sent{kLocalEpoch_ns + from_seconds(t_s).ns};
  return {.sender_ns = kSenderEpoch_ns + from_seconds(t_s * (1 - skew)).ns,
          .sent = sent,
          .arrival = {sent.ns + from_seconds(kSmallestDelay_s + delay_s).ns}};
}

// Errors of the mapped stamps less the smallest delay, from `from_s` on.
std::vector<double> errors_s(double skew, const Delay_s& delay, double from_s, double to_s,
                             unsigned seed) {
  std::mt19937 random(seed);
  ClockMap clock;
  std::vector<double> errors;
  for (int k = 0; k * kPeriod_s < to_s; ++k) {
    const Sample sample = sample_at(k, skew, delay(random));
    const FilteredStamp mapped = clock.map(sample.sender_ns, sample.arrival);
    if (k * kPeriod_s < from_s) continue;
    errors.push_back(seconds_between(sample.sent, mapped.stamp) - kSmallestDelay_s);
  }
  return errors;
}

double quantile_of_absolute(std::vector<double> values, double ratio) {
  for (double& value : values) value = std::abs(value);
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(ratio * double(values.size()));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// Delays with a standard deviation of 15 ms.
double exponential_s(std::mt19937& random) {
  return std::exponential_distribution<double>(1 / 0.015)(random);
}
double uniform_s(std::mt19937& random) {
  return std::uniform_real_distribution<double>(0, 0.015 * std::sqrt(12.0))(random);
}
double half_normal_s(std::mt19937& random) {
  return std::abs(std::normal_distribution<double>(0, 0.015 / 0.6028)(random));
}

TEST(ClockMap, ErrsByLessThanThreeMillisecondsAfterThirtySeconds) {
  for (const auto& delay : {exponential_s, uniform_s, half_normal_s}) {
    for (const double skew : {50e-6, -50e-6}) {
      std::vector<double> all;
      for (unsigned seed = 1; seed <= 10; ++seed) {
        const std::vector<double> errors = errors_s(skew, delay, 30, 90, seed);
        all.insert(all.end(), errors.begin(), errors.end());
      }
      EXPECT_LT(quantile_of_absolute(all, 0.95), 0.003);
    }
  }
}

TEST(ClockMap, IsExactWithoutJitter) {
  for (const double error_s : errors_s(
           50e-6, [](auto&) { return 0.0; }, 1, 20, 1)) {
    EXPECT_NEAR(error_s, 0, 1e-7);
  }
}

TEST(ClockMap, MeasuresTheSkew) {
  std::mt19937 random(1);
  ClockMap clock;
  for (int k = 0; k < 60 * 30; ++k) {
    const Sample sample = sample_at(k, 50e-6, exponential_s(random));
    static_cast<void>(clock.map(sample.sender_ns, sample.arrival));
  }
  EXPECT_NEAR(clock.skew(), 50e-6, 20e-6);
  EXPECT_NEAR(clock.mean_delay_s(), 0.015, 0.002);
}

TEST(ClockMap, SigmaCoversTheErrorsAfterASecond) {
  std::mt19937 random(2);
  ClockMap clock;
  int outside = 0;
  for (int k = 0; k < 30 * 30; ++k) {
    const Sample sample = sample_at(k, 50e-6, exponential_s(random));
    const FilteredStamp mapped = clock.map(sample.sender_ns, sample.arrival);
    if (k < 30) continue;
    const double error_s = seconds_between(sample.sent, mapped.stamp) - kSmallestDelay_s;
    if (std::abs(error_s) > 3 * mapped.sigma_s) ++outside;
  }
  EXPECT_LT(outside, 20 * 30 / 20);
}

TEST(ClockMap, FollowsASenderThatRestarts) {
  ClockMap clock;
  for (int k = 0; k < 100; ++k) {
    const Sample sample = sample_at(k, 0, 0);
    static_cast<void>(clock.map(sample.sender_ns, sample.arrival));
  }
  for (const double step_s : {1000.0, -1000.0}) {
    for (int k = 100; k < 110; ++k) {
      Sample sample = sample_at(k, 0, 0);
      sample.sender_ns += from_seconds(step_s).ns;
      const FilteredStamp mapped = clock.map(sample.sender_ns, sample.arrival);
      EXPECT_NEAR(seconds_between(sample.arrival, mapped.stamp), 0, 1e-6);
    }
  }
  EXPECT_EQ(clock.restarts(), 2);
}

TEST(ClockMap, KeepsItsLineOverABurstOfLateArrivals) {
  ClockMap clock;
  for (int k = 0; k < 300; ++k) {
    const bool is_held_up = k >= 200 && k < 290;
    Sample sample = sample_at(k, 0, 0);
    if (is_held_up) sample.arrival = sample_at(290, 0, 0).arrival;
    const FilteredStamp mapped = clock.map(sample.sender_ns, sample.arrival);
    EXPECT_NEAR(seconds_between(sample.sent, mapped.stamp), kSmallestDelay_s, 1e-6) << k;
  }
  EXPECT_EQ(clock.restarts(), 0);
}

}  // namespace
}  // namespace stillkite
