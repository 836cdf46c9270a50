#include "evaluation/truth_check.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/angle.hpp"

namespace stillkite {
namespace {

// Position on a path of changing speed.
Eigen::Vector3d on_path(double t_s) {
  return {2 * t_s + std::sin(t_s), 1.5 * std::sin(0.8 * t_s), 10 + 0.3 * std::sin(0.5 * t_s)};
}

std::vector<EvaluatedMotion> path_estimates() {
  std::vector<StampedPose> poses;
  for (int i = 0; i < 300; ++i) {
    poses.push_back({from_seconds(i / 30.0), {.translation = on_path(i / 30.0)}});
  }
  return evaluated_motions(poses);
}

// Truth at 20 Hz, x' = scale * R(yaw) x, on a clock `ahead_s` ahead.
Truth path_truth(double ahead_s, double yaw_rad, double scale) {
  Truth truth;
  for (int i = 0; i < 200; ++i) {
    const double t_s = i / 20.0;
    const Eigen::Quaterniond R = so3_exp({0, 0, yaw_rad});
    truth.poses.push_back(
        {from_seconds(t_s + ahead_s), {.rotation = R, .translation = scale * (R * on_path(t_s))}});
  }
  return truth;
}

TEST(TruthMismatch, IsAbsentForAnEqualTruth) {
  EXPECT_FALSE(truth_mismatch(path_estimates(), path_truth(0, 0, 1)));
  EXPECT_FALSE(truth_mismatch(path_estimates(), path_truth(0.01, 0.02, 1.3)));
}

TEST(TruthMismatch, FindsAClockOffset) {
  for (const double ahead_s : {0.2, -0.5, 2.0}) {
    const auto found = truth_mismatch(path_estimates(), path_truth(ahead_s, 0, 1));
    ASSERT_TRUE(found) << ahead_s;
    EXPECT_EQ(found->cause, TruthMismatch::Cause::clock);
    EXPECT_NEAR(found->value, ahead_s, 0.01);
    EXPECT_GT(found->explained_ratio, 0.9);
  }
}

TEST(TruthMismatch, FindsTheClockOfTrueVelocities) {
  Truth truth;
  for (int i = 0; i < 100; ++i) {
    const double t_s = i / 10.0, h_s = 1e-4;
    truth.velocities.push_back(
        {from_seconds(t_s - 0.3), (on_path(t_s + h_s) - on_path(t_s - h_s)) / (2 * h_s)});
  }
  const auto found = truth_mismatch(path_estimates(), truth);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->cause, TruthMismatch::Cause::clock);
  EXPECT_NEAR(found->value, -0.3, 0.02);
}

TEST(TruthMismatch, FindsARotationAboutTheVertical) {
  for (const double yaw_deg : {90.0, -8.0, 180.0}) {
    const auto found = truth_mismatch(path_estimates(), path_truth(0, yaw_deg * kDegree, 1));
    ASSERT_TRUE(found) << yaw_deg;
    EXPECT_EQ(found->cause, TruthMismatch::Cause::heading);
    EXPECT_NEAR(std::remainder(found->value - yaw_deg * kDegree, 2 * M_PI), 0, 0.01);
  }
}

TEST(TruthMismatch, FindsLengthsInAnotherUnit) {
  for (const double scale : {1000.0, 100.0, 1e-5}) {
    const auto found = truth_mismatch(path_estimates(), path_truth(0, 0.1, scale));
    ASSERT_TRUE(found) << scale;
    EXPECT_EQ(found->cause, TruthMismatch::Cause::scale);
    EXPECT_NEAR(found->value / scale, 1, 0.01);
  }
}

// A drifting estimate is wrong itself: no rotation or scaling explains its error.
TEST(TruthMismatch, IsAbsentForADriftingEstimate) {
  std::vector<EvaluatedMotion> estimates = path_estimates();
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    const double t_s = static_cast<double>(i) / 30;
    estimates[i].world_from_body.translation.y() += 0.02 * t_s * t_s;
  }
  EXPECT_FALSE(truth_mismatch(estimates, path_truth(0, 0, 1)));
  EXPECT_FALSE(truth_mismatch({}, path_truth(0, 0, 1)));
}

TEST(TruthJump, FindsOutliersAndHeldPositions) {
  Truth truth = path_truth(0, 0, 1);
  EXPECT_FALSE(truth_jump(truth.poses));
  truth.poses[50].world_from_body.translation.y() += 5;
  const auto outlier = truth_jump(truth.poses);
  ASSERT_TRUE(outlier);
  EXPECT_EQ(outlier->count, 2);
  EXPECT_NEAR(outlier->length_m, 5, 0.2);
  truth = path_truth(0, 0, 1);
  for (std::size_t i = 101; i < 140; ++i) {
    truth.poses[i].world_from_body = truth.poses[100].world_from_body;
  }
  const auto held = truth_jump(truth.poses);
  ASSERT_TRUE(held);
  EXPECT_EQ(held->count, 1);
  EXPECT_EQ(held->stamp, truth.poses[140].stamp);
}

}  // namespace
}  // namespace stillkite
