#include "estimation/sliding_window/marginalization.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <random>

#include "estimation/sliding_window/initialization.hpp"
#include "estimation/sliding_window/window_solver.hpp"
#include "hand_held_motion.hpp"

namespace stillkite {
namespace {

constexpr ImuNoise kWindowImu{
    .gyro_density = 2e-4, .accel_density = 2e-3, .gyro_bias_walk = 2e-5, .accel_bias_walk = 1e-4};

// Window at the truth: four frames, the first two are keyframes with points.
Window true_window() {
  const HandHeldMotion motion;
  std::mt19937 random(5);
  Window window;
  window.extrinsics = window.first_extrinsics = motion.extrinsics;
  const auto points = points_in_view(motion, 40, random);
  constexpr double kInterval_s = 0.2;
  for (int i = 0; i < 4; ++i) {
    const double t_s = kInterval_s * i;
    WindowFrame frame;
    frame.id = i;
    frame.stamp = from_seconds(t_s);
    frame.state = motion.state(t_s);
    frame.is_keyframe = i < 2;
    frame.imu = ImuPreintegration(kWindowImu);
    frame.imu.reintegrate(motion.gyro_bias_rad_s, motion.accel_bias_m_s2);
    if (i > 0) {
      for (const ImuSample& sample : motion.samples(t_s - kInterval_s, t_s, kWindowImu, random)) {
        frame.imu.add(sample);
      }
    }
    append_frame(window, std::move(frame));
    for (const FeatureObservation& feature : observe(motion, t_s, points, 1e-3, random)) {
      const auto known = std::find_if(window.tracks.begin(), window.tracks.end(),
                                      [&](const auto& t) { return t.id == feature.track_id; });
      const bool is_of_second = feature.track_id % 2 == 1;
      if (known != window.tracks.end()) {
        known->observations.push_back({i, feature.bearing, feature.covariance.inverse()});
      } else if (i == (is_of_second ? 1 : 0)) {
        const RigidTransform world_from_camera =
            motion.state(t_s).world_from_imu * motion.extrinsics.imu_from_camera;
        const Eigen::Vector3d x =
            world_from_camera.inverse() * points[static_cast<std::size_t>(feature.track_id)];
        window.tracks.push_back({feature.track_id,
                                 {{i, feature.bearing, feature.covariance.inverse()}},
                                 InverseDepthPoint{x.hnormalized(), 1 / x.z()}});
      }
    }
  }
  std::sort(window.tracks.begin(), window.tracks.end(),
            [](const auto& a, const auto& b) { return a.id < b.id; });
  set_initial_prior(window, InertialPriors{});
  return window;
}

Eigen::VectorXd newton_step(const Window& window, Eigen::MatrixXd& covariance) {
  const WindowEquations equations = window_equations(window, whole_window(window));
  const Eigen::LLT<Eigen::MatrixXd> factor(equations.information);
  const Eigen::Index size = equations.gradient.size();
  covariance = factor.solve(Eigen::MatrixXd::Identity(size, size));
  return factor.solve(equations.gradient);
}

TEST(Marginalization, OfVelocityAndBiasesKeepsStepAndCovarianceOfTheRest) {
  Window window = true_window();
  Eigen::MatrixXd before, after;
  const Eigen::VectorXd step = newton_step(window, before);
  marginalize_motion(window, 0);
  const Eigen::VectorXd kept = newton_step(window, after);
  constexpr int kNewest = InertialIndex::kSize;
  EXPECT_LT((kept.tail<kNewest>() - step.tail<kNewest>()).norm(), 1e-6 * step.norm());
  const Eigen::MatrixXd expected = before.bottomRightCorner(kNewest, kNewest);
  const Eigen::MatrixXd difference = after.bottomRightCorner(kNewest, kNewest) - expected;
  EXPECT_LT(difference.norm(), 1e-6 * expected.norm());
}

// Observations of the other keyframe's points in the removed frame are lost, and so is nothing
// else: the covariance does not shrink, and grows little.
TEST(Marginalization, OfAKeyframeNeverGainsInformation) {
  Window window = true_window();
  Eigen::MatrixXd before, after;
  newton_step(window, before);
  marginalize_frame(window, 0);
  EXPECT_EQ(window.frames.size(), 3U);
  newton_step(window, after);
  constexpr int kNewest = InertialIndex::kSize;
  const Eigen::VectorXd ratio =
      after.diagonal().tail<kNewest>().array() / before.diagonal().tail<kNewest>().array();
  EXPECT_GT(ratio.minCoeff(), 1 - 1e-6);
  EXPECT_LT(ratio.maxCoeff(), 3);
}

TEST(Marginalization, MergedFrameKeepsTheImuChain) {
  Window window = true_window();
  const double duration_s = window.frames[2].imu.duration_s() + window.frames[3].imu.duration_s();
  merge_frame(window, 2);
  ASSERT_EQ(window.frames.size(), 3U);
  EXPECT_DOUBLE_EQ(window.frames[2].imu.duration_s(), duration_s);
  EXPECT_EQ(window.prior.gradient.size(), window.offsets().back());
  for (const WindowTrack& track : window.tracks) {
    for (const WindowObservation& observation : track.observations) {
      EXPECT_TRUE(window.find(observation.frame_id));
    }
  }
}

}  // namespace
}  // namespace stillkite
