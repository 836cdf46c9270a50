#include "navigation/inertial_steps.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace stillkite {
namespace {

InertialReading reading_at(double t_s, double rate_rad_s) {
  return {.stamp = from_seconds(t_s),
          .angular_rate_in_body_rad_s = {rate_rad_s, 0, 0},
          .specific_force_in_body_m_s2 = {0, 0, 9.8}};
}

std::vector<InertialStep> steps_of(const std::vector<InertialReading>& readings) {
  return inertial_steps(readings, from_seconds(1), from_seconds(1.1),
                        Eigen::Quaterniond::Identity());
}

double duration_s(const std::vector<InertialStep>& steps) {
  double sum = 0;
  for (const InertialStep& step : steps) sum += step.dt_s;
  return sum;
}

// Camera and IMU stamps differ: without extension the rest of the interval is unmeasured.
TEST(InertialSteps, ExtendLastStepToImage) {
  const std::vector<InertialStep> steps = steps_of({reading_at(1.05, 1), reading_at(1.095, 2)});
  ASSERT_EQ(steps.size(), 2u);
  EXPECT_NEAR(steps[0].dt_s, 0.05, 1e-9);
  EXPECT_NEAR(steps[1].dt_s, 0.05, 1e-9);
  EXPECT_EQ(steps[1].angular_rate_rad_s->x(), 2);
}

TEST(InertialSteps, LeaveLongGapsOpen) {
  EXPECT_NEAR(duration_s(steps_of({reading_at(1.05, 1)})), 0.05, 1e-9);
  EXPECT_TRUE(steps_of({}).empty());
  EXPECT_TRUE(steps_of({reading_at(0.99, 1), reading_at(1.2, 1)}).empty());
}

// Readings missing from 1.02 to 1.07 s.
TEST(InertialSteps, LeaveGapBetweenReadingsOpen) {
  InertialReading after = reading_at(1.08, 2);
  after.valid_from = from_seconds(1.07);
  const std::vector<InertialStep> steps =
      steps_of({reading_at(1.02, 1), after, reading_at(1.1, 3)});
  ASSERT_EQ(steps.size(), 3u);
  EXPECT_NEAR(steps[0].dt_s, 0.02, 1e-9);
  EXPECT_NEAR(steps[1].dt_s, 0.01, 1e-9);
  EXPECT_NEAR(duration_s(steps), 0.05, 1e-9);
}

TEST(InertialSteps, SkipNonFiniteAndUnorderedReadings) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<InertialStep> steps = steps_of(
      {reading_at(1.05, 1), reading_at(1.03, 5), reading_at(1.07, nan), reading_at(1.1, 2)});
  ASSERT_EQ(steps.size(), 2u);
  EXPECT_NEAR(steps[1].dt_s, 0.05, 1e-9);
  EXPECT_EQ(steps[1].angular_rate_rad_s->x(), 2);
}

}  // namespace
}  // namespace stillkite
