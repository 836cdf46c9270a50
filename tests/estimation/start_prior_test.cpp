#include "estimation/start_prior.hpp"

#include <gtest/gtest.h>

#include "estimation/fusion_filter.hpp"

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
      frames[i].after_views.emplace_back(
          [](FusionFilter& filter) { filter.update_up(Eigen::Vector3d(0.1, 0.02, 1)); });
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
  return config;
}

// A filter that clones a frame's pose (as its keyframe, and the anchor's as its anchor) corrects
// the clone by all that follows: what a smoother makes of it, to first order.
TEST(StartPrior, IsWhatAFilterOfClonesKnowsInTheEnd) {
  constexpr std::size_t kAnchor = 1;
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

  // Of the last frame's errors from the anchor's; in the filter they are in metres and the
  // anchor's axes, with the scale's error.
  const Matrix6d last = prior.covariance.block<6, 6>(6 * kLast, 6);
  const RigidTransform seen = filter.anchor_from_camera_m();
  const Eigen::Matrix3d R = state.world_from_anchor.rotation.toRotationMatrix();
  const Eigen::Matrix3d turn =
      R * filter.anchored_covariance().bottomRightCorner<3, 3>() * R.transpose();
  EXPECT_LT((last.topLeftCorner<3, 3>() - turn).norm(), 0.02 * turn.norm());
  EXPECT_GT(seen.translation.norm(), 0.01) << "the case tells nothing";
  EXPECT_LT((last - last.transpose()).norm(), 1e-9 * last.norm());
  EXPECT_GT(last.llt().info() == Eigen::Success, 0);
  // what two frames share is alike from either side
  const Matrix6d a = prior.covariance.block<6, 6>(6 * chosen[0], 6);
  const Matrix6d b = prior.covariance.block<6, 6>(6 * kLast, 0);
  EXPECT_LT((a - b.transpose()).norm(), 1e-9 * a.norm());
}

}  // namespace
}  // namespace stillkite
