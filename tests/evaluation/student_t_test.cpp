#include "evaluation/student_t.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace stillkite {
namespace {

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
