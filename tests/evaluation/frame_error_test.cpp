#include "evaluation/frame_error.hpp"

#include <gtest/gtest.h>

namespace stillkite {
namespace {

constexpr int kSteps = 40;
constexpr auto kPosition = static_cast<std::size_t>(FrameFigure::position);
constexpr auto kVelocity = static_cast<std::size_t>(FrameFigure::velocity);
constexpr auto kAttitude = static_cast<std::size_t>(FrameFigure::attitude);
constexpr auto kAngularRate = static_cast<std::size_t>(FrameFigure::angular_rate);

// 2 m/s along x, yaw rate 0.5 rad/s.
Truth turning_flight() {
  Truth truth;
  for (int i = 0; i < kSteps; ++i) {
    const double t_s = 0.1 * i;
    truth.poses.push_back({.stamp = from_seconds(t_s),
                           .world_from_body = {.rotation = so3_exp({0, 0, 0.5 * t_s}),
                                               .translation = {2 * t_s, 0, 10}}});
  }
  return truth;
}

// Truth with a lateral offset `offset_m` and a roll error of 0.01 rad in the world.
std::vector<EvaluatedMotion> offset_estimate(const Truth& truth, double offset_m) {
  std::vector<EvaluatedMotion> estimates = evaluated_motions(truth.poses);
  for (EvaluatedMotion& estimate : estimates) {
    RigidTransform& pose = estimate.world_from_body;
    pose.translation.y() += offset_m;
    pose.rotation = so3_exp({0.01, 0, 0}) * pose.rotation;
    estimate.twist_in_camera = Twist{.angular_rate_rad_s = {0, 0, 0.8}};
  }
  return estimates;
}

TEST(FrameErrors, MatchSimulatedErrors) {
  const Truth truth = turning_flight();
  const std::vector<FrameError> errors = frame_errors(offset_estimate(truth, 0.3), truth);
  ASSERT_EQ(errors.size(), std::size_t{kSteps});
  EXPECT_FALSE(errors[0][kVelocity]) << "no twist at the first frame";
  EXPECT_NEAR(errors[7][kPosition].value(), 0.3, 1e-12);
  EXPECT_NEAR(errors[7][kAttitude].value(), 0.01, 1e-12);
  EXPECT_NEAR(errors[7][kVelocity].value(), 2, 1e-9) << "estimated velocity is 0";
  EXPECT_NEAR(errors[7][kAngularRate].value(), 0.3, 1e-9);
  EXPECT_NEAR(mean_error(errors, FrameFigure::position).value(), 0.3, 1e-12);
}

TEST(FrameErrors, NonMetricEstimateHasNoLengthErrors) {
  const Truth truth = turning_flight();
  std::vector<EvaluatedMotion> estimates = offset_estimate(truth, 0.3);
  for (EvaluatedMotion& estimate : estimates) estimate.is_metric = false;
  estimates[8].is_metric = true;
  estimates[9].is_metric = true;
  const std::vector<FrameError> errors = frame_errors(estimates, truth);
  EXPECT_FALSE(errors[7][kPosition]);
  EXPECT_FALSE(errors[7][kVelocity]);
  EXPECT_TRUE(errors[7][kAttitude]);
  EXPECT_TRUE(errors[7][kAngularRate]);
  EXPECT_NEAR(errors[8][kPosition].value(), 0.3, 1e-12);
  EXPECT_NEAR(mean_error(errors, FrameFigure::velocity).value(), 2, 1e-9);
}

TEST(FrameErrors, TruthOfPositionsHasNoAttitudeErrors) {
  Truth truth = turning_flight();
  const std::vector<EvaluatedMotion> estimates = offset_estimate(truth, 0.3);
  truth.has_attitude = false;
  const std::vector<FrameError> errors = frame_errors(estimates, truth);
  EXPECT_NEAR(errors[7][kPosition].value(), 0.3, 1e-12);
  EXPECT_TRUE(errors[7][kVelocity]);
  EXPECT_FALSE(errors[7][kAttitude]);
  EXPECT_FALSE(errors[7][kAngularRate]);
}

TEST(MeanError, IsEmptyForOneFrame) {
  FrameError error;
  error[kPosition] = 0;
  EXPECT_FALSE(mean_error({&error, 1}, FrameFigure::position));
}

TEST(PairedDifference, IsTheDifferenceOfConstantErrors) {
  const Truth truth = turning_flight();
  const std::vector<FrameError> worse = frame_errors(offset_estimate(truth, -0.3), truth);
  std::vector<FrameError> better = frame_errors(offset_estimate(truth, 0.1), truth);
  better[3][kPosition].reset();
  const auto difference = paired_difference(worse, better, FrameFigure::position);
  ASSERT_TRUE(difference);
  EXPECT_EQ(difference->samples, kSteps - 1);
  EXPECT_NEAR(difference->mean, 0.2, 1e-12);
  EXPECT_TRUE(differs_from_zero(*difference));
  EXPECT_FALSE(differs_from_zero(*paired_difference(worse, better, FrameFigure::angular_rate)));
}

// One run ends a frame earlier.
TEST(PairedDifference, UsesCommonFramesOnly) {
  const Truth truth = turning_flight();
  const std::vector<FrameError> errors = frame_errors(offset_estimate(truth, 0.3), truth);
  const std::span<const FrameError> shorter(errors.data(), errors.size() - 1);
  EXPECT_EQ(paired_difference(errors, shorter, FrameFigure::attitude)->samples, kSteps - 1);
  EXPECT_FALSE(paired_difference(errors, shorter.first(19), FrameFigure::attitude));
}

}  // namespace
}  // namespace stillkite
