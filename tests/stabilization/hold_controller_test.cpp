#include "stabilization/hold_controller.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "geometry/angle.hpp"
#include "stabilization/tether_rates.hpp"
#include "tests/stabilization/hold_scene.hpp"

namespace stillkite {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr Timestamp kNow{10'000'000'000};

enum class Flaw { none, rotation, displacement, shift, parallax, attitude, zero_quaternion, huge };
constexpr std::array kFlaws = {Flaw::none,     Flaw::rotation, Flaw::displacement,    Flaw::shift,
                               Flaw::parallax, Flaw::attitude, Flaw::zero_quaternion, Flaw::huge};

enum class Tether { absent, stale, in_the_future, slack, not_finite, absurd, zenith, full, low };
constexpr std::array kTethers = {Tether::absent, Tether::stale,      Tether::in_the_future,
                                 Tether::slack,  Tether::not_finite, Tether::absurd,
                                 Tether::zenith, Tether::full,       Tether::low};

std::optional<TetherReading> reading(Tether kind) {
  TetherReading r{kNow, {5, 1, 0.3}};
  switch (kind) {
    case Tether::absent:
      return std::nullopt;
    case Tether::stale:
      r.stamp = from_seconds(9);
      break;
    case Tether::in_the_future:
      r.stamp = from_seconds(10.1);
      break;
    case Tether::slack:
      r.taut = false;
      break;
    case Tether::not_finite:
      r.tether.azimuth_rad = kNaN;
      break;
    case Tether::absurd:
      r.tether.length_m = -1e9;
      break;
    case Tether::zenith:
      r.tether = {2, pi / 2, 0};
      break;
    case Tether::full:
      r.tether = {20.001, 0.7, 3};
      break;
    case Tether::low:
      r.tether = {0.4, -0.01, -3};
      break;
  }
  return r;
}

struct Case {
  HoldMode mode = HoldMode::recommended;
  std::optional<EstimateStatus> status = EstimateStatus::ok;
  DisplacementKind kind = DisplacementKind::metric;
  Flaw flaw = Flaw::none;
  double age_s = 0.1;
  Tether tether = Tether::zenith;
  double yaw_rad = 0;
};

HoldInput input_of(const Case& c) {
  const RigidTransform reference{forward_camera(), {0, 0, 2}};
  const RigidTransform camera{so3_exp({0, 0, c.yaw_rad}) * forward_camera(), {0.4, 0.3, 2.2}};
  MotionEstimate e = exact_estimate(reference, camera);
  e.displacement_kind = c.kind;
  if (c.kind == DisplacementKind::direction) e.displacement_in_reference.normalize();
  if (c.kind == DisplacementKind::zero) e.displacement_in_reference.setZero();
  e.parallax_rad = 0.1;
  e.stamp = from_seconds(to_seconds(kNow) - c.age_s);
  HoldInput input{.now = kNow, .tether = reading(c.tether), .station_from_camera = camera.rotation};
  switch (c.flaw) {
    case Flaw::none:
      break;
    case Flaw::rotation:
      e.reference_from_camera.x() = kNaN;
      break;
    case Flaw::displacement:
      e.displacement_in_reference.y() = 1 / 0.0;
      break;
    case Flaw::shift:
      e.mean_shift_px = kNaN;
      break;
    case Flaw::parallax:
      e.parallax_rad = kNaN;
      break;
    case Flaw::attitude:
      input.station_from_camera.w() = kNaN;
      break;
    case Flaw::zero_quaternion:
      e.reference_from_camera.coeffs().setZero();
      break;
    case Flaw::huge:
      e.displacement_in_reference *= 1e300;
      break;
  }
  if (c.status) {
    e.status = *c.status;
    input.estimate = e;
  }
  return input;
}

std::vector<Case> every_case() {
  std::vector<Case> cases;
  const std::array<std::optional<EstimateStatus>, 5> statuses = {
      std::nullopt, EstimateStatus::ok, EstimateStatus::gated, EstimateStatus::predicted,
      EstimateStatus::lost};
  for (const HoldMode mode : {HoldMode::paper, HoldMode::recommended}) {
    for (const auto& status : statuses) {
      for (const auto& [kind, name] : EnumNames<DisplacementKind>::value) {
        for (const Flaw flaw : kFlaws) {
          for (const double age_s : {0.0, 0.1, 0.6, -0.1}) {
            for (const Tether tether : kTethers) {
              for (const double yaw_rad : {0.0, 0.07, 0.5, -3.0}) {
                cases.push_back({mode, status, kind, flaw, age_s, tether, yaw_rad});
              }
            }
          }
        }
      }
    }
  }
  return cases;
}

// Expected reason, in the documented order of the tests.
HoldReason expected_reason(const Case& c) {
  if (!c.status) return HoldReason::no_estimate;
  if (*c.status == EstimateStatus::lost) return HoldReason::estimate_lost;
  if (*c.status == EstimateStatus::gated) return HoldReason::estimate_gated;
  if (*c.status == EstimateStatus::predicted && c.kind != DisplacementKind::metric) {
    return HoldReason::estimate_lost;
  }
  if (c.age_s < 0 || c.age_s > 0.5) return HoldReason::estimate_stale;
  if (c.flaw != Flaw::none && c.flaw != Flaw::huge) return HoldReason::not_finite;
  if (c.tether == Tether::absent) return HoldReason::no_tether_reading;
  if (c.tether == Tether::stale || c.tether == Tether::in_the_future) {
    return HoldReason::tether_stale;
  }
  if (c.tether == Tether::slack && c.mode == HoldMode::paper) return HoldReason::tether_slack;
  if (c.tether == Tether::not_finite) return HoldReason::not_finite;
  if (c.tether == Tether::absurd) return HoldReason::tether_out_of_range;
  const double max_yaw_rad = c.mode == HoldMode::paper ? 5 * kDegree : 20 * kDegree;
  if (std::abs(c.yaw_rad) > max_yaw_rad) return HoldReason::angle_first;
  if (c.kind == DisplacementKind::unknown) return HoldReason::displacement_unknown;
  if (c.kind == DisplacementKind::zero && c.mode == HoldMode::paper) {
    return HoldReason::within_dead_band;
  }
  if (c.tether == Tether::full || c.tether == Tether::low) return HoldReason::at_limit;
  return c.tether == Tether::slack ? HoldReason::tether_slack : HoldReason::none;
}

bool may_move(HoldReason reason) {
  return reason == HoldReason::none || reason == HoldReason::tether_slack ||
         reason == HoldReason::at_limit;
}

bool may_yaw(HoldReason reason) {
  return reason == HoldReason::angle_first || reason == HoldReason::displacement_unknown ||
         may_move(reason);
}

void expect_valid(const HoldDecision& decision) {
  const TetherCommand& c = decision.command;
  const bool moves =
      c.length_rate_m_s != 0 || c.elevation_rate_rad_s != 0 || c.azimuth_rate_rad_s != 0;
  const bool any = moves || c.yaw_rate_rad_s != 0;
  ASSERT_EQ(decision.action, any ? HoldAction::command : HoldAction::hold);
  ASSERT_TRUE(any || decision.reason != HoldReason::none);
  ASSERT_TRUE(!moves || may_move(decision.reason));
  // a comparison with a NaN is false
  ASSERT_TRUE(std::abs(c.length_rate_m_s) <= 0.3);
  ASSERT_TRUE(std::abs(c.elevation_rate_rad_s) <= 0.25);
  ASSERT_TRUE(std::abs(c.azimuth_rate_rad_s) <= 0.2);
  ASSERT_TRUE(std::abs(c.yaw_rate_rad_s) <= 0.4);
  ASSERT_TRUE(decision.position_error_in_station_m.allFinite());
  ASSERT_TRUE(std::isfinite(decision.yaw_error_rad));
}

TEST(HoldController, CommandsOrHoldsWithReasonInEveryCombination) {
  for (const Case& c : every_case()) {
    HoldConfig config{.mode = c.mode};
    HoldController controller(config);
    const HoldDecision decision = controller.decide(input_of(c));
    expect_valid(decision);
    if (testing::Test::HasFatalFailure()) return;
    const HoldReason expected = expected_reason(c);
    if (expected == HoldReason::none && decision.reason == HoldReason::within_dead_band) {
      ASSERT_TRUE(c.kind == DisplacementKind::zero);
    } else {
      ASSERT_EQ(name_of(decision.reason), name_of(expected));
    }
    if (!may_yaw(expected) && c.mode != HoldMode::paper) {
      ASSERT_EQ(decision.action, HoldAction::hold);
    }
    const bool healthy = expected == HoldReason::none && c.kind != DisplacementKind::zero;
    // the ends of length and elevation never suppress all three rates
    ASSERT_TRUE(!healthy || decision.action == HoldAction::command);
  }
}

TEST(HoldController, StaysWithinLimitsOverAllInputsInSequence) {
  for (const HoldMode mode : {HoldMode::paper, HoldMode::recommended}) {
    HoldConfig config{.mode = mode};
    config.paper.length.integral = config.paper.yaw.integral = config.recommended.yaw.integral = 1;
    config.recommended.position.derivative = 0.3;
    config.recommended.position.slew_limit = 1;
    HoldController controller(config);
    int k = 0;
    for (const Case& c : every_case()) {
      HoldInput input = input_of(c);
      const std::int64_t later_ns = 33'000'000LL * ++k;
      input.now.ns += later_ns;
      if (input.estimate) input.estimate->stamp.ns += later_ns;
      if (input.tether) input.tether->stamp.ns += later_ns;
      expect_valid(controller.decide(input));
      if (testing::Test::HasFatalFailure()) return;
    }
  }
}

// A reason of operator or ground station precedes those of the estimate. The drone is then not
// modelled as moving: on release the first command is that of a new controller.
TEST(HoldController, WithholdsEveryCommandForAReasonFromOutside) {
  HoldController controller({}), fresh({});
  HoldInput input = input_of({});
  const HoldInput first = input;
  for (int k = 0; k < 60; ++k) {
    input.withheld = HoldReason::not_engaged;
    const HoldDecision held = controller.decide(input);
    ASSERT_EQ(held.action, HoldAction::hold);
    ASSERT_EQ(held.reason, HoldReason::not_engaged);
    input.now.ns += 33'000'000;
    input.estimate->stamp.ns += 33'000'000;
    input.tether->stamp.ns += 33'000'000;
  }
  input.withheld = HoldReason::none;
  const TetherCommand released = controller.decide(input).command;
  const TetherCommand expected = fresh.decide(first).command;
  EXPECT_GT(std::abs(expected.length_rate_m_s) + std::abs(expected.elevation_rate_rad_s), 0.1);
  // the lead over one step differs from that of a first step, 3 %
  EXPECT_NEAR(released.elevation_rate_rad_s, expected.elevation_rate_rad_s, 0.01);
  EXPECT_NEAR(released.length_rate_m_s, expected.length_rate_m_s, 0.01);
  input.estimate.reset();
  input.withheld = HoldReason::station_silent;
  EXPECT_EQ(controller.decide(input).reason, HoldReason::station_silent);
}

// Wind holds the drone at an elevation below the minimum, while the modelled one is above it.
TEST(HoldController, LimitsElevationByTheMeasuredDirection) {
  HoldConfig config;
  config.limits.min_elevation_rad = 0.5;
  const auto elevation_rate = [&](double measured_rad, double error_up_m) {
    HoldController controller(config);
    HoldInput input = input_of({});
    input.tether->tether = {5, 0.8, 0.3};
    (void)controller.decide(input);  // initializes the model
    input.now.ns += 33'000'000;
    input.estimate->stamp = input.tether->stamp = input.now;
    input.tether->tether.elevation_rad = measured_rad;
    input.estimate->displacement_in_reference =
        forward_camera().conjugate() * Vector3d(0, 0, -error_up_m);
    const HoldDecision decision = controller.decide(input);
    EXPECT_EQ(decision.reason == HoldReason::at_limit, measured_rad < 0.5);
    return decision.command.elevation_rate_rad_s;
  };
  EXPECT_LT(elevation_rate(0.8, -0.5), -0.05);
  EXPECT_EQ(elevation_rate(0.45, -0.5), 0);
  EXPECT_GT(elevation_rate(0.45, 0.5), 0.05);
  // (distance to the end) / 2 s
  EXPECT_NEAR(elevation_rate(0.52, -0.5), -0.01, 1e-12);
}

// Limit: 10 cm standard deviation over all axes. A covariance that is not finite is rejected.
TEST(HoldController, UsesPredictedPositionWhileItsCovarianceIsSmall) {
  const auto reason_at = [](double variance_m2) {
    Case c{.status = EstimateStatus::predicted, .kind = DisplacementKind::metric};
    HoldInput input = input_of(c);
    input.estimate->displacement_covariance = variance_m2 * Eigen::Matrix3d::Identity();
    return HoldController({}).decide(input).reason;
  };
  EXPECT_EQ(reason_at(0.0032), HoldReason::none);
  EXPECT_EQ(reason_at(0.0034), HoldReason::estimate_lost);
  EXPECT_EQ(reason_at(std::numeric_limits<double>::quiet_NaN()), HoldReason::estimate_lost);
}

// Drone below the reference position, at the zenith, tether slack: the reel pays out at most
// `max_slack_m` beyond the last taut length.
TEST(HoldController, LimitsLengthPaidOutWhileSlack) {
  HoldConfig config;
  HoldController controller(config);
  HoldInput input = input_of({.tether = Tether::zenith});
  input.estimate->displacement_in_reference = forward_camera().conjugate() * Vector3d(0, 0, -1);
  double length_m = 2;
  const auto length_rate_at = [&](double t_s, bool taut) {
    input.now = input.estimate->stamp = input.tether->stamp = from_seconds(t_s);
    input.tether->tether.length_m = length_m;
    input.tether->taut = taut;
    return controller.decide(input).command.length_rate_m_s;
  };
  EXPECT_GT(length_rate_at(0, true), 0);
  for (int k = 1; k <= 400; ++k) length_m += 0.03 * length_rate_at(0.03 * k, false);
  EXPECT_NEAR(length_m, 2 + config.max_slack_m, 0.01);
  EXPECT_GT(length_rate_at(12.1, true), 0.2);
}

TEST(HoldController, ResetsWhenTheClockRunsBackwards) {
  HoldController used({}), fresh({});
  HoldInput input = input_of({});
  for (int k = 0; k < 100; ++k) {
    input.now.ns += 33'000'000;
    input.estimate->stamp = input.tether->stamp = input.now;
    (void)used.decide(input);
  }
  const HoldDecision after_reset = used.decide(input_of({}));
  EXPECT_EQ(after_reset.command.elevation_rate_rad_s,
            fresh.decide(input_of({})).command.elevation_rate_rad_s);
}

TEST(HoldController, HoldsOnTiltInPaperModeOnly) {
  Case c{.mode = HoldMode::paper};
  HoldInput input = input_of(c);
  input.estimate->reference_from_camera = so3_exp({6 * kDegree, 0, 0});
  HoldController paper(HoldConfig{.mode = HoldMode::paper});
  const HoldDecision held = paper.decide(input);
  EXPECT_EQ(held.action, HoldAction::hold);
  EXPECT_EQ(held.reason, HoldReason::angle_first);
  HoldController recommended({});
  EXPECT_EQ(recommended.decide(input).reason, HoldReason::none);
}

TEST(HoldController, HoldsUpToTwentyPixelsInPaperMode) {
  HoldInput input = input_of({.mode = HoldMode::paper, .yaw_rad = 0.05});
  HoldController controller(HoldConfig{.mode = HoldMode::paper});
  input.estimate->mean_shift_px = 20;
  EXPECT_EQ(controller.decide(input).action, HoldAction::hold);
  input.estimate->mean_shift_px = 20.5;
  EXPECT_EQ(controller.decide(input).action, HoldAction::command);
}

TEST(HoldController, EstimatesUnknownLengthByDepthTimesParallax) {
  HoldController controller({});
  const HoldDecision d = controller.decide(input_of({.kind = DisplacementKind::direction}));
  EXPECT_NEAR(d.position_error_in_station_m.norm(), 4.0 * 0.1, 1e-12);
}

TEST(HoldController, CommandsIntegratedDriftAtZeroDisplacement) {
  HoldConfig config;
  config.recommended.predict = false;
  config.recommended.position.integral = 1;
  HoldController controller(config);
  HoldInput input = input_of({.tether = Tether::zenith});
  input.tether->tether = {5, 1, 0.3};
  const auto at = [&](double t_s, const Vector3d& error_m) {
    input.now = input.estimate->stamp = input.tether->stamp = from_seconds(t_s);
    input.estimate->displacement_kind =
        error_m.isZero() ? DisplacementKind::zero : DisplacementKind::metric;
    input.estimate->displacement_in_reference = forward_camera().conjugate() * -error_m;
    const TetherCommand c = controller.decide(input).command;
    return Vector3d(velocity_in_station_m_s({5, 1, 0.3}, c));
  };
  (void)at(0, {0.05, 0, 0});
  for (int k = 1; k <= 100; ++k) (void)at(0.01 * k, {0.05, 0, 0});
  // integral of the error beyond the dead band of 2 cm over one second
  const Vector3d drift = at(1.01, Vector3d::Zero());
  EXPECT_NEAR(drift.x(), 0.03, 1e-6);
  EXPECT_LT(drift.tail<2>().norm(), 1e-9);
  // a longer loss resets it
  input.estimate->status = EstimateStatus::lost;
  EXPECT_EQ(at(2, Vector3d::Zero()).norm(), 0);
  input.estimate->status = EstimateStatus::ok;
  EXPECT_NEAR(at(2.5, Vector3d::Zero()).x(), 0.03, 1e-6);
  EXPECT_EQ(at(5, Vector3d::Zero()).norm(), 0);
}

TEST(HoldController, CommandsNoAzimuthRateAtZeroRateLimit) {
  HoldConfig config;
  config.limits.azimuth_rate_rad_s = 0;
  for (const Vector3d& velocity_m_s : {Vector3d(0, 0, 0), Vector3d(0.2, 0.1, 0)}) {
    HoldController controller(config);
    HoldInput input = input_of({.tether = Tether::zenith});
    input.estimate->twist_in_camera = Twist{.velocity_m_s = velocity_m_s};
    for (int k = 0; k < 30; ++k) {
      input.now.ns += 33'000'000;
      input.estimate->stamp = input.tether->stamp = input.now;
      const HoldDecision d = controller.decide(input);
      ASSERT_EQ(d.action, HoldAction::command);
      ASSERT_EQ(d.command.azimuth_rate_rad_s, 0);
    }
  }
}

// Near the zenith the azimuth rotates towards the drift; a longer loss resets the drift.
TEST(HoldController, ResetsAzimuthDriftAfterLongLoss) {
  HoldController used({}), fresh({});
  HoldInput input = input_of({.tether = Tether::zenith});
  input.estimate->displacement_in_reference.setZero();
  const auto azimuth_rate_at = [&](HoldController& controller, double t_s, double lateral_m_s) {
    input.now = input.estimate->stamp = input.tether->stamp = from_seconds(t_s);
    input.estimate->twist_in_camera = Twist{.velocity_m_s = {lateral_m_s, 0, 0}};
    return controller.decide(input).command.azimuth_rate_rad_s;
  };
  double drifting_rad_s = 0;
  for (int k = 0; k < 60; ++k) drifting_rad_s = azimuth_rate_at(used, k / 30.0, 0.2);
  EXPECT_GT(std::abs(drifting_rad_s), 0.1);
  input.estimate->status = EstimateStatus::lost;
  for (int k = 60; k < 240; ++k) (void)azimuth_rate_at(used, k / 30.0, 0);
  input.estimate->status = EstimateStatus::ok;
  EXPECT_NEAR(azimuth_rate_at(used, 8, 0), azimuth_rate_at(fresh, 8, 0), 0.03);
}

TEST(HoldController, RejectsEmptyLengthRange) {
  HoldConfig config;
  config.limits.min_length_m = 20;
  EXPECT_THROW(HoldController{config}, InputError);
}

}  // namespace
}  // namespace stillkite
