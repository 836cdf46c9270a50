#include "estimation/sliding_window/imu_timeline.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace stillkite {
namespace {

ImuInterval interval(double from_s, double to_s, double rate_rad_s) {
  return {.from = from_seconds(from_s),
          .to = from_seconds(to_s),
          .angular_rate_rad_s = {rate_rad_s, 0, 0},
          .specific_force_m_s2 = {0, 0, 9.8}};
}

// Readings of 0.1 s each up to 1 s, without those from 0.4 to 0.6 s.
ImuTimeline timeline_with_gap() {
  ImuTimeline timeline(interval(0, 0, -1));
  for (int i = 0; i < 10; ++i) {
    if (i == 4 || i == 5) continue;
    const std::vector<ImuInterval> reading{interval(0.1 * i, 0.1 * (i + 1), i)};
    timeline.add(reading);
  }
  return timeline;
}

TEST(ImuTimeline, CutsTheFirstAndTheLastReading) {
  const std::vector<ImuSample> samples =
      timeline_with_gap().between(from_seconds(0.15), from_seconds(0.32));
  ASSERT_EQ(samples.size(), 3U);
  EXPECT_NEAR(samples[0].dt_s, 0.05, 1e-9);
  EXPECT_NEAR(samples[1].dt_s, 0.1, 1e-9);
  EXPECT_NEAR(samples[2].dt_s, 0.02, 1e-9);
  EXPECT_EQ(samples[0].angular_rate_rad_s.x(), 1);
  EXPECT_EQ(samples[2].angular_rate_rad_s.x(), 3);
  for (const ImuSample& sample : samples) EXPECT_FALSE(sample.is_gap);
}

TEST(ImuTimeline, HoldsTheReadingBeforeAGap) {
  const std::vector<ImuSample> samples =
      timeline_with_gap().between(from_seconds(0.3), from_seconds(0.7));
  ASSERT_EQ(samples.size(), 3U);
  EXPECT_TRUE(samples[1].is_gap);
  EXPECT_NEAR(samples[1].dt_s, 0.2, 1e-9);
  EXPECT_EQ(samples[1].angular_rate_rad_s.x(), 3);
}

TEST(ImuTimeline, IsAGapBeforeAndAfterTheReadings) {
  const ImuTimeline timeline = timeline_with_gap();
  const auto before = timeline.between(from_seconds(-0.1), from_seconds(0.1));
  ASSERT_EQ(before.size(), 2U);
  EXPECT_TRUE(before[0].is_gap);
  EXPECT_EQ(before[0].angular_rate_rad_s.x(), -1);
  const auto after = timeline.between(from_seconds(1), from_seconds(1.05));
  ASSERT_EQ(after.size(), 1U);
  EXPECT_TRUE(after[0].is_gap);
  EXPECT_EQ(after[0].angular_rate_rad_s.x(), 9);
}

TEST(ImuTimeline, LeavesOutWhatIsKnown) {
  ImuTimeline timeline = timeline_with_gap();
  const std::vector<ImuInterval> repeated{interval(0.8, 0.9, 50), interval(0.95, 1.1, 60)};
  timeline.add(repeated);
  const auto samples = timeline.between(from_seconds(0.8), from_seconds(1.1));
  ASSERT_EQ(samples.size(), 3U);
  EXPECT_EQ(samples[0].angular_rate_rad_s.x(), 8);
  EXPECT_NEAR(samples[2].dt_s, 0.1, 1e-9);
  EXPECT_EQ(samples[2].angular_rate_rad_s.x(), 60);
}

TEST(ImuTimeline, KeepsTheLastForgottenReading) {
  ImuTimeline timeline = timeline_with_gap();
  timeline.forget_before(from_seconds(0.75));
  EXPECT_EQ(timeline.between(from_seconds(0.72), from_seconds(0.8)).size(), 1U);
  EXPECT_EQ(timeline.at(from_seconds(0.1)).angular_rate_rad_s.x(), 6);
  EXPECT_EQ(timeline.at(from_seconds(0.85)).angular_rate_rad_s.x(), 8);
}

}  // namespace
}  // namespace stillkite
