#include "estimation/sliding_window/sliding_window.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "true_window.hpp"
#include "window_run.hpp"

namespace stillkite {
namespace {

TEST(SlidingWindow, InitializesWithoutHeightOrAttitude) {
  WindowRun run(1);
  while (!run.window->is_initialized() && run.frame < 60) run.step();
  ASSERT_TRUE(run.window->is_initialized());
  EXPECT_LT(run.window->last_initialization().scale_sigma_ratio, 0.1);
  EXPECT_LT((run.window->state().gyro_bias_rad_s - run.motion.gyro_bias_rad_s).norm(), 0.005);
  const Eigen::Vector3d up =
      run.window->state().world_from_imu.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d true_up =
      run.truth().world_from_imu.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  EXPECT_LT(angle_between_rad(up, true_up), 0.03);
}

// Mean NEES over 15 s of five flights; expectation 3 for each group, and position and yaw are
// relative to the first frame.
TEST(SlidingWindow, CovarianceIsConsistent) {
  constexpr int kFrames = 300;
  Eigen::Matrix<double, 5, 1> sum = Eigen::Matrix<double, 5, 1>::Zero();
  int count = 0;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    WindowRun run(seed);
    std::optional<RigidTransform> truth_from_world;
    while (run.frame < kFrames) {
      run.step();
      if (!run.window->is_initialized()) continue;
      if (!truth_from_world) truth_from_world = run.truth_from_world();
      const InertialState state = run.aligned_state(*truth_from_world);
      const InertialError error = minus(run.truth(), state);
      const SlidingWindow::Matrix15d& P = run.window->covariance();
      for (int group = 0; group < 5; ++group) {
        Eigen::Matrix3d covariance = P.block<3, 3>(3 * group, 3 * group);
        const bool is_in_world =
            3 * group == InertialIndex::kPosition || 3 * group == InertialIndex::kVelocity;
        if (is_in_world) {
          const Eigen::Matrix3d R = truth_from_world->rotation.toRotationMatrix();
          covariance = R * covariance * R.transpose();
        }
        const Eigen::Vector3d e = error.segment<3>(3 * group);
        sum[group] += e.dot(covariance.ldlt().solve(e));
      }
      ++count;
    }
  }
  ASSERT_GT(count, 1400);
  const Eigen::Matrix<double, 5, 1> mean = sum / count;
  EXPECT_LT(mean.maxCoeff(), 6) << mean.transpose();
  EXPECT_GT(mean.minCoeff(), 0.5) << mean.transpose();
}

// A new clock offset moves the states by velocity and angular rate.
TEST(InitialPrior, KeepsPositionAndYawOfTheFirstFrame) {
  Window window = true_window();
  const auto pose = [&](std::size_t frame) { return window.frames[frame].state.world_from_imu; };
  set_initial_prior(window, {});
  const RigidTransform before = pose(0);
  window.extrinsics.time_offset_s += 0.02;
  linearize_at_present(window);
  const RigidTransform last_from_first = pose(3).inverse() * pose(0);
  ASSERT_GT((pose(0).translation - before.translation).norm(), 5e-3);
  set_initial_prior(window, {});
  EXPECT_LT((pose(0).translation - before.translation).norm(), 1e-12);
  EXPECT_NEAR((pose(0).rotation * before.rotation.conjugate()).z(), 0, 1e-12);
  const RigidTransform after = pose(3).inverse() * pose(0);
  EXPECT_LT((after.translation - last_from_first.translation).norm(), 1e-12);
  EXPECT_LT(angle_between_rad(after.rotation, last_from_first.rotation), 1e-7);
}

TEST(SlidingWindow, InitializesAtRestByTheImu) {
  constexpr double kFrame_s = WindowRun::kFrame_s;
  constexpr ImuNoise kImu = WindowRun::kImu;
  HandHeldMotion motion;
  motion.amplitude_m = 0;
  motion.tilt_rad = 0;
  motion.accel_bias_m_s2.setZero();
  std::mt19937 random(3);
  const auto points = points_in_view(motion, 100, random);
  RigidTransform first = motion.state(0).world_from_imu;
  first.rotation = first.rotation * so3_exp({0.2, -0.3, 0});
  SlidingWindow window(motion.extrinsics, first, kImu, InertialPriors{});
  for (int frame = 0; frame < 20; ++frame) {
    const double t_s = kFrame_s * frame;
    const auto features = observe(motion, t_s, points, WindowRun::kBearingSigma, random);
    const auto readings = frame == 0 ? std::vector<ImuInterval>()
                                     : motion.readings(t_s - kFrame_s, t_s, kImu, random);
    const std::optional<CameraRest> rest =
        frame < 10 ? std::nullopt : std::optional(CameraRest{from_seconds(0), 0.001});
    window.add_frame(from_seconds(t_s), readings, features, rest);
    if (frame == 0) window.take_keyframe(features);
  }
  ASSERT_TRUE(window.is_initialized());
  EXPECT_LT((window.state().gyro_bias_rad_s - motion.gyro_bias_rad_s).norm(), 1e-3);
  EXPECT_EQ(window.state().velocity_in_world_m_s.norm(), 0);
  const Eigen::Vector3d up = window.state().world_from_imu.rotation * Eigen::Vector3d::UnitZ();
  EXPECT_LT(angle_between_rad(up, Eigen::Vector3d(Eigen::Vector3d::UnitZ())), 1e-3);
}

TEST(SlidingWindow, IsNotInitializedAfterARestart) {
  WindowRun run(4);
  while (!run.window->is_initialized() && run.frame < 60) run.step();
  ASSERT_TRUE(run.window->is_initialized());
  ASSERT_NE(run.window->extrinsics().time_offset_s, 0);
  run.window->restart();
  EXPECT_EQ(run.window->extrinsics().time_offset_s, 0);
  EXPECT_FALSE(run.window->is_initialized());
  EXPECT_TRUE(run.window->is_restarted());
  EXPECT_EQ(run.window->window().frames.size(), 1U);
}

TEST(SlidingWindow, PredictsByTheImuWithoutFeatures) {
  WindowRun run(2);
  while (run.frame < 100) run.step();
  const RigidTransform truth_from_world = run.truth_from_world();
  const auto sigma = [&](int group) {
    return std::sqrt(run.window->covariance().block<3, 3>(group, group).trace());
  };
  const double velocity_sigma_m_s = sigma(InertialIndex::kVelocity);
  for (int i = 0; i < 20; ++i) run.step_in_the_dark();
  const InertialState state = run.aligned_state(truth_from_world);
  const double error_m =
      (state.world_from_imu.translation - run.truth().world_from_imu.translation).norm();
  EXPECT_GT(sigma(InertialIndex::kVelocity), 1.5 * velocity_sigma_m_s);
  EXPECT_LT(error_m, 4 * sigma(InertialIndex::kPosition));
}

// Half of the points is seen at the start only, the others for two seconds each: position drifts.
// The first ones, seen again, put it back.
TEST(SlidingWindow, ReturnToTheReferenceRemovesDrift) {
  constexpr double kFrame_s = WindowRun::kFrame_s;
  constexpr int kSeenAtFirst_s = 5;
  constexpr int kAway_s = 15;
  constexpr int kHalf = 100;
  WindowRun run(6);
  const auto visible = [&](auto&& is_visible) {
    auto features = run.features();
    std::erase_if(features, [&](const auto& f) { return !is_visible(f.track_id); });
    return features;
  };
  const auto is_first = [](std::int64_t id) { return id < kHalf; };
  while (kFrame_s * run.frame < kSeenAtFirst_s) run.advance(visible(is_first));
  ASSERT_TRUE(run.window->is_initialized());
  const RigidTransform truth_from_world = run.truth_from_world();
  const std::int64_t reference = run.window->window().reference_id;
  while (kFrame_s * run.frame < kSeenAtFirst_s + kAway_s) {
    const double newest = kHalf * (kFrame_s * run.frame - kSeenAtFirst_s + 2) / (kAway_s + 2);
    run.advance(visible([&](std::int64_t id) {
      const double order = static_cast<double>(id) - kHalf;
      return order > newest - 2.0 * kHalf / (kAway_s + 2) - 1 && order <= newest;
    }));
  }
  const auto sigma_m = [&] {
    return std::sqrt(run.window->covariance().block<3, 3>(3, 3).trace());
  };
  const double drift_sigma_m = sigma_m();
  ASSERT_EQ(run.window->window().reference_id, reference);
  ASSERT_TRUE(run.window->window().find(reference));
  for (int i = 0; i < 3; ++i) {
    const auto features = visible(is_first);
    run.advance({});
    run.window->take_keyframe({}, features);
  }
  run.advance({});
  const InertialState state = run.aligned_state(truth_from_world);
  const double error_m =
      (state.world_from_imu.translation - run.truth().world_from_imu.translation).norm();
  EXPECT_LT(sigma_m(), 0.5 * drift_sigma_m);
  EXPECT_LT(error_m, 4 * sigma_m());
}

struct Mounting {
  double time_offset_s;
  double lever_arm_m;
};

class WrongMounting : public testing::TestWithParam<Mounting> {};

// Clock and lever arm that differ from the calibration, with the sigmas of InertialPriors.
TEST_P(WrongMounting, IsEstimated) {
  WindowRun run(6);
  run.time_offset_s = GetParam().time_offset_s;
  run.motion.extrinsics.imu_from_camera.translation.y() += GetParam().lever_arm_m;
  while (run.frame < 200) run.step();
  const CameraExtrinsics& estimate = run.window->extrinsics();
  EXPECT_NEAR(estimate.time_offset_s, GetParam().time_offset_s, 0.003);
  const Eigen::Vector3d lever_arm_m = run.motion.extrinsics.imu_from_camera.translation;
  EXPECT_LT((estimate.imu_from_camera.translation - lever_arm_m).norm(), 0.06);
  const double clock_s = run.window->window().first_extrinsics.time_offset_s;
  const InertialState truth = run.motion.state(WindowRun::kFrame_s * (run.frame - 1) + clock_s);
  EXPECT_NEAR(run.window->state().velocity_in_world_m_s.norm(), truth.velocity_in_world_m_s.norm(),
              0.03);
}
INSTANTIATE_TEST_SUITE_P(Each, WrongMounting,
                         testing::Values(Mounting{-0.06, 0}, Mounting{0.02, 0}, Mounting{0.06, 0},
                                         Mounting{0, 0.1}));

}  // namespace
}  // namespace stillkite
