#include "evaluation/association.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace stillkite {
namespace {

StampedPose at(double t_s, double x_m, double yaw_rad = 0) {
  return {.stamp = from_seconds(t_s),
          .world_from_body = {.rotation = so3_exp({0, 0, yaw_rad}), .translation = {x_m, 0, 0}}};
}

TEST(PoseAt, InterpolatesBetweenNeighbours) {
  const std::vector<StampedPose> poses{at(1.0, 10, 0.0), at(1.1, 20, 0.2)};
  const auto pose = pose_at(poses, from_seconds(1.025), 0.03);
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->translation.x(), 12.5, 1e-9);
  EXPECT_NEAR(so3_log(pose->rotation).z(), 0.05, 1e-9);
}

TEST(PoseAt, RequiresANeighbourWithinTolerance) {
  const std::vector<StampedPose> poses{at(1.0, 10), at(1.1, 20)};
  EXPECT_FALSE(pose_at(poses, from_seconds(1.05), 0.03));
  EXPECT_FALSE(pose_at(poses, from_seconds(0.9), 0.03));
  EXPECT_FALSE(pose_at(poses, from_seconds(1.2), 0.03));
  EXPECT_FALSE(pose_at({}, from_seconds(1.0), 0.03));
  EXPECT_DOUBLE_EQ(pose_at(poses, from_seconds(0.98), 0.03)->translation.x(), 10);
  EXPECT_DOUBLE_EQ(pose_at(poses, from_seconds(1.12), 0.03)->translation.x(), 20);
  EXPECT_DOUBLE_EQ(pose_at(poses, from_seconds(1.1), 0)->translation.x(), 20);
}

TEST(VelocityAt, InterpolatesBetweenNeighbours) {
  const std::vector<StampedVelocity> velocities{{from_seconds(1.0), {10, 0, 2}},
                                                {from_seconds(1.1), {20, 0, 2}}};
  const auto velocity = velocity_at(velocities, from_seconds(1.025), 0.03);
  ASSERT_TRUE(velocity);
  EXPECT_NEAR((*velocity - Eigen::Vector3d(12.5, 0, 2)).norm(), 0, 1e-9);
  EXPECT_FALSE(velocity_at(velocities, from_seconds(1.05), 0.03));
  EXPECT_DOUBLE_EQ(velocity_at(velocities, from_seconds(1.12), 0.03)->x(), 20);
}

TEST(TwistAt, ReturnsTheNearestSample) {
  const std::vector<StampedTwist> twists{{from_seconds(1.0), {.velocity_m_s = {1, 0, 0}}},
                                         {from_seconds(1.1), {.velocity_m_s = {2, 0, 0}}}};
  EXPECT_DOUBLE_EQ(twist_at(twists, from_seconds(1.04), 0.05)->velocity_m_s.x(), 1);
  EXPECT_DOUBLE_EQ(twist_at(twists, from_seconds(1.06), 0.05)->velocity_m_s.x(), 2);
  EXPECT_DOUBLE_EQ(twist_at(twists, from_seconds(1.12), 0.05)->velocity_m_s.x(), 2);
  EXPECT_DOUBLE_EQ(twist_at(twists, from_seconds(0.98), 0.05)->velocity_m_s.x(), 1);
  EXPECT_FALSE(twist_at(twists, from_seconds(1.2), 0.05));
  EXPECT_FALSE(twist_at({}, from_seconds(1.0), 0.05));
}

TEST(Associate, KeepsTheIndexOfTheEstimate) {
  const std::vector<StampedPose> estimates{at(0.5, 1), at(1.0, 2), at(2.0, 3), at(3.0, 4)};
  const std::vector<StampedPose> truth{at(1.0, 5), at(3.0, 7), at(3.01, 7)};
  const auto pairs = associate(estimates, truth, 0.01);
  ASSERT_EQ(pairs.size(), 2U);
  EXPECT_EQ(pairs[0].index, 1U);
  EXPECT_EQ(pairs[1].index, 3U);
  EXPECT_DOUBLE_EQ(pairs[1].estimate.translation.x(), 4);
  EXPECT_DOUBLE_EQ(pairs[1].truth.translation.x(), 7);
}

// GNSS at 5 Hz, 17 ms off the frames of a camera at 30 Hz: one estimate for each row between two.
TEST(Associate, InterpolatesATruthBetweenFrames) {
  std::vector<StampedPose> estimates, truth;
  for (int i = 0; i <= 60; ++i) estimates.push_back(at(i / 30.0, 0));
  for (int i = 0; i <= 9; ++i) truth.push_back(at(0.0167 + 0.2 * i, 10 * (0.0167 + 0.2 * i)));
  const auto pairs = associate(estimates, truth, 0.01);
  ASSERT_EQ(pairs.size(), 9U);
  for (const PosePair& pair : pairs) {
    EXPECT_NEAR(pair.truth.translation.x(), 10 * to_seconds(pair.stamp), 1e-9);
  }
  truth.erase(truth.begin() + 3, truth.begin() + 6);  // a gap of four intervals
  EXPECT_EQ(associate(estimates, truth, 0.01).size(), 5U);
}

// Constant yaw rate on a straight path: the velocity is expressed at the mean yaw of both poses.
TEST(MeanTwist, IsExactForConstantYawRateOnAStraightPath) {
  const double yaw_rate_rad_s = 0.8;
  const double dt_s = 0.25;
  const RigidTransform before{so3_exp({0, 0, 0.3}), {0, 0, 5}};
  const RigidTransform after{so3_exp({0, 0, 0.3 + yaw_rate_rad_s * dt_s}), {2 * dt_s, 0, 5}};
  const Twist twist = mean_twist(before, after, dt_s);
  const double mean_yaw_rad = 0.3 + 0.5 * yaw_rate_rad_s * dt_s;
  EXPECT_NEAR(twist.velocity_m_s.x(), 2 * std::cos(mean_yaw_rad), 1e-12);
  EXPECT_NEAR(twist.velocity_m_s.y(), -2 * std::sin(mean_yaw_rad), 1e-12);
  EXPECT_NEAR(twist.velocity_m_s.z(), 0, 1e-12);
  EXPECT_NEAR(twist.angular_rate_rad_s.z(), yaw_rate_rad_s, 1e-12);
}

}  // namespace
}  // namespace stillkite
