#include "stabilization/pid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace stillkite {
namespace {

constexpr double kSample_s = 0.01;
constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

TEST(Pid, ProportionalOnAnIntegratorDecaysGeometrically) {
  const PidConfig config{.proportional = 0.8, .output_limit = 10};
  PidState state;
  double x = 3;
  for (int k = 1; k <= 500; ++k) {
    const PidStep now = step(config, state, -x, kSample_s);
    state = now.state;
    x += kSample_s * now.output;
    // sampled at dt the exponential exp(-P t) is (1 - P dt)^k
    ASSERT_NEAR(x, 3 * std::pow(1 - 0.8 * kSample_s, k), 1e-12);
  }
  EXPECT_NEAR(x, 3 * std::exp(-0.8 * 5), 0.01 * 3 * std::exp(-0.8 * 5) * 2);
}

TEST(Pid, IntegralFollowsARampWithoutError) {
  const auto error_on_ramp = [](double integral) {
    const PidConfig config{.proportional = 2, .integral = integral, .output_limit = 10};
    PidState state;
    double x = 0;
    double error = 0;
    for (int k = 0; k < 3000; ++k) {
      error = 0.2 * k * kSample_s - x;
      const PidStep now = step(config, state, error, kSample_s);
      state = now.state;
      x += kSample_s * now.output;
    }
    return error;
  };
  EXPECT_NEAR(error_on_ramp(0), 0.2 / 2, 1e-9);  // v / P
  EXPECT_NEAR(error_on_ramp(1), 0, 1e-9);
}

// Overshoot of an integrating plant with speed limit 0.1 over its target of 1.
double overshoot(double integral_limit, bool bounded) {
  PidConfig config{.proportional = 1, .integral = 0.25, .integral_limit = integral_limit};
  config.output_limit = bounded ? 0.1 : 1e9;
  PidState state;
  double x = 0;
  double max_overshoot = 0;
  for (int k = 0; k < 6000; ++k) {
    const PidStep now = step(config, state, 1 - x, kSample_s);
    state = now.state;
    x += kSample_s * std::clamp(now.output, -0.1, 0.1);
    max_overshoot = std::max(max_overshoot, x - 1);
  }
  return max_overshoot;
}

TEST(Pid, IntegralDoesNotWindUpAtTheLimit) {
  // P = 1, I = 1/4 is a double pole at -1/2: entered at error 0.1 with an empty integral the error
  // is (0.1 - 0.05 t) exp(-t/2), whose least is -0.1 exp(-2) at t = 4 s
  EXPECT_NEAR(overshoot(10, true), 0.1 * std::exp(-2), 5e-4);
  EXPECT_GT(overshoot(10, false), 0.5);
}

TEST(Pid, DerivativeOfARampIsItsSlope) {
  const PidConfig config{
      .proportional = 0, .derivative = 3, .output_limit = 10, .derivative_filter_s = 0.2};
  PidState state;
  double output = 0;
  for (int k = 0; k < 400; ++k) {
    const PidStep now = step(config, state, 0.5 * k * kSample_s, kSample_s);
    state = now.state;
    output = now.output;
    // k samples of the low pass: slope (1 - (tau / (tau + dt))^k)
    ASSERT_NEAR(output, 3 * 0.5 * (1 - std::pow(0.2 / 0.21, k)), 1e-9);
  }
  EXPECT_NEAR(output, 1.5, 1e-7);
}

TEST(Pid, DeadBandStartsFromZeroAtItsEdge) {
  const PidConfig config{.proportional = 2, .dead_band = 0.1, .output_limit = 10};
  EXPECT_EQ(step(config, {}, 0.1, kSample_s).output, 0);
  EXPECT_EQ(step(config, {}, -0.09, kSample_s).output, 0);
  EXPECT_NEAR(step(config, {}, 0.15, kSample_s).output, 0.1, 1e-12);
  EXPECT_NEAR(step(config, {}, -0.3, kSample_s).output, -0.4, 1e-12);
}

TEST(Pid, OutputAndSlewStayWithinTheirBounds) {
  const PidConfig config{.proportional = 5, .output_limit = 1, .slew_limit = 2};
  PidState state;
  for (int k = 1; k <= 100; ++k) {
    const PidStep now = step(config, state, 100, kSample_s);
    state = now.state;
    ASSERT_NEAR(now.output, std::min(1.0, 2 * k * kSample_s), 1e-12);
  }
}

TEST(Pid, IgnoresNonFiniteInputs) {
  const PidConfig config{.integral = 1};
  const PidState state = step(config, {}, 0.3, kSample_s).state;
  for (const double error : {kNotANumber, std::numeric_limits<double>::infinity()}) {
    const PidStep now = step(config, state, error, kSample_s);
    EXPECT_EQ(now.output, 0);
    EXPECT_EQ(now.state.integral, state.integral);
  }
  EXPECT_EQ(step(config, state, 0.3, kNotANumber).output, 0);
  EXPECT_EQ(step(config, state, 0.3, -1).state.integral, state.integral);
}

}  // namespace
}  // namespace stillkite
