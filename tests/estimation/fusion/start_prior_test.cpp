#include "estimation/fusion/start_prior.hpp"

#include <gtest/gtest.h>

#include "estimation/fusion/fusion_filter.hpp"
#include "geometry/angle.hpp"

namespace stillkite {
namespace {

constexpr std::size_t kPriorFrames = 8;

FusionStart moving_start() {
  return {.world_from_camera = {so3_exp({0.2, -0.1, 0.4}), {0, 0, 3}}, .velocity_sigma = 0.5};
}

// Told a gyroscope and an accelerometer, and now and then the vertical and the height.
std::vector<ToldFrame> told_frames() {
  std::vector<ToldFrame> frames(kPriorFrames);
  for (std::size_t i = 0; i < kPriorFrames; ++i) {
    const double t = static_cast<double>(i);
    auto& told = frames[i].before_views;
    told.emplace_back([](FusionFilter& filter) { filter.begin_step(); });
    for (int step = 0; step < 2; ++step) {
      told.emplace_back([=](FusionFilter& filter) {
        filter.predict({.dt_s = 0.1,
                        .angular_rate_rad_s = Eigen::Vector3d(0.1, 0.05 * t, -0.2),
                        .is_gyro = true,
                        .specific_force_m_s2 = Eigen::Vector3d(0.5, -0.3 * t, 9.6)});
      });
    }
    if (i % 3 == 2) {
      told.emplace_back([](FusionFilter& filter) { filter.update_height(3, 0.1); });
      frames[i].after_views.emplace_back([](FusionFilter& filter) {
        filter.update_up(Eigen::Vector3d(0.1, 0.02, 1), 1 * kDegree);
      });
    }
  }
  return frames;
}

void tell(FusionFilter& filter, const ToldFrame& frame) {
  for (const auto& told : frame.before_views) told(filter);
  for (const auto& told : frame.after_views) told(filter);
}

FusionConfig plain() {
  FusionConfig config;
  config.relinearize_start = false;
  config.landmarks = 0;
  config.scale_sigma_ratio = config.height_sigma_ratio = 1e-6;  // that a map unit is a metre
  return config;
}

// A filter that clones a frame's pose (as its keyframe, and the anchor's as its anchor) corrects
// the clone by all that follows: what a smoother makes of it, to first order.
TEST(StartPrior, IsWhatAFilterOfClonesKnowsInTheEnd) {
  constexpr std::size_t kAnchor = 3;
  constexpr std::size_t kLast = kPriorFrames - 1;
  const std::vector<ToldFrame> frames = told_frames();
  const std::vector<std::size_t> chosen{4, kLast};
  const StartPrior prior = start_prior(plain(), moving_start(), frames, kAnchor, chosen);
  ASSERT_EQ(prior.world_from_camera.size(), kPriorFrames);
  FusionFilter filter(plain(), moving_start());
  for (std::size_t i = 0; i < kPriorFrames; ++i) {
    tell(filter, frames[i]);
    if (i == kAnchor) filter.take_anchor();
    if (i == chosen[0]) filter.take_keyframe();
  }
  const FusionState& state = filter.state();
  const auto expect_near = [&](std::size_t frame, const RigidTransform& pose) {
    const RigidTransform& smoothed = prior.world_from_camera[frame];
    EXPECT_LT((smoothed.translation - pose.translation).norm(), 2e-3) << frame;
    EXPECT_LT(smoothed.rotation.angularDistance(pose.rotation), 1e-3) << frame;
  };
  expect_near(kAnchor, state.world_from_anchor);
  expect_near(chosen[0], state.world_from_keyframe);
  expect_near(kLast, state.world_from_camera);

  // of the last pose, from the anchor
  const Matrix6d last = prior.covariance.block<6, 6>(6 * kLast, 6);
  const Eigen::Matrix3d R = state.world_from_anchor.rotation.toRotationMatrix();
  Matrix6d to_world;
  to_world << Eigen::Matrix3d::Zero(), R, R, Eigen::Matrix3d::Zero();
  const Matrix6d filtered = to_world * filter.anchored_covariance() * to_world.transpose();
  const Vector6d sigma = filtered.diagonal().cwiseSqrt();
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) {
      EXPECT_NEAR(last(row, column), filtered(row, column), 0.02 * sigma[row] * sigma[column])
          << row << ", " << column;
    }
  }
  EXPECT_GT(filter.anchor_from_camera_m().translation.norm(), 0.01) << "the case tells nothing";
  EXPECT_LT((last - last.transpose()).norm(), 1e-9 * last.norm());
  EXPECT_EQ(last.llt().info(), Eigen::Success);
  // what two frames share is alike from either side
  const Matrix6d a = prior.covariance.block<6, 6>(6 * chosen[0], 6);
  const Matrix6d b = prior.covariance.block<6, 6>(6 * kLast, 0);
  EXPECT_LT((a - b.transpose()).norm(), 1e-9 * a.norm());
}

}  // namespace
}  // namespace stillkite
