#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "simulation/flight/bench_scene.hpp"

namespace stillkite {
namespace {

// Twist between the poses, in the camera frame.
TEST(BenchScene, PosesMatchTwist) {
  for (const BenchMotion& motion : {kBenchSceneA, kBenchSceneB}) {
    const BenchScene scene = make_bench_scene(motion, cv::Mat(64, 64, CV_8UC1, cv::Scalar(9)), 1);
    const RigidTransform previous_from_current =
        scene.world_from_previous.inverse() * scene.world_from_current;
    EXPECT_LT((so3_log(previous_from_current.rotation) / scene.interval_s -
               motion.angular_rate_in_camera_rad_s)
                  .norm(),
              1e-12);
    // integration of the twist in small steps
    constexpr int kSteps = 20000;
    const double step_s = scene.interval_s / kSteps;
    const RigidTransform step{so3_exp(step_s * scene.twist_in_camera.angular_rate_rad_s),
                              step_s * scene.twist_in_camera.velocity_m_s};
    RigidTransform moved;
    for (int k = 0; k < kSteps; ++k) moved = moved * step;
    EXPECT_LT((moved.translation - previous_from_current.translation).norm(),
              1e-6 * motion.forward_m_s);
    EXPECT_NEAR(scene.twist_in_camera.velocity_m_s.norm(), motion.forward_m_s, 1e-12);
    EXPECT_NEAR(scene.ground.height_m, motion.height_m, 1e-12);
  }
}

TEST(BenchScene, NoiseIsIndependentBetweenSeeds) {
  const BenchScene scene = make_bench_scene(kBenchSceneA, cv::Mat(), 1);
  const FramePair one = with_noise(scene, 1.5, 1);
  const FramePair again = with_noise(scene, 1.5, 1);
  const FramePair other = with_noise(scene, 1.5, 2);
  EXPECT_EQ(cv::norm(one.previous, again.previous, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(one.current, again.current, cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(one.previous, other.previous, cv::NORM_L2), 1000);
  EXPECT_GT(cv::norm(one.current, other.current, cv::NORM_L2), 1000);
}

}  // namespace
}  // namespace stillkite
