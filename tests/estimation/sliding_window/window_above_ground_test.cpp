#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>

#include "estimation/plane/keyframe_pose.hpp"
#include "window_run.hpp"

namespace stillkite {
namespace {

// Motion over level ground, 4 m below, with objects on it; the camera looks down.
struct FlightAboveGround {
  explicit FlightAboveGround(double object_height_m, double given_height_ratio = 1,
                             double level_slope_rad = 5e-4)
      : run(3) {
    constexpr double kHeight_m = 4;
    run.motion.extrinsics.imu_from_camera = {so3_exp({3.1, 0.05, 0.02}), {-0.02, -0.06, 0.01}};
    std::uniform_real_distribution<double> across(-4, 4);
    std::uniform_real_distribution<double> height(0, object_height_m);
    for (Eigen::Vector3d& point : run.points) {
      point << across(run.random), across(run.random), height(run.random) - kHeight_m;
    }
    const RigidTransform true_first = run.motion.state(0).world_from_imu;
    true_height_m = true_first.translation.z() + kHeight_m;
    RigidTransform first = true_first;
    first.translation.z() = given_height_ratio * true_height_m;
    run.window.emplace(run.motion.extrinsics, first, WindowRun::kImu, InertialPriors{},
                       StartAboveGround{.world_from_imu = first,
                                        .height_sigma_m = 0.05 * true_height_m,
                                        .tilt_sigma_rad = 0.02,
                                        .level_slope_rad = level_slope_rad,
                                        .relief = GroundRelief(true_height_m)});
  }
  [[nodiscard]] RigidTransform ground_from_camera(int frame) const {
    RigidTransform pose = run.motion.state(WindowRun::kFrame_s * frame).world_from_imu *
                          run.motion.extrinsics.imu_from_camera;
    pose.translation.z() += true_height_m - run.motion.state(0).world_from_imu.translation.z();
    return pose;
  }

  // With an alignment to the ground of relative accuracy 2e-4; `displacement`: its error, in
  // heights.
  void step_aligned(const Eigen::Vector3d& displacement = Eigen::Vector3d::Zero()) {
    constexpr double kSigma = 2e-4;
    constexpr int kKeyframeInterval = 20;
    std::normal_distribution<double> normal(0, kSigma);
    KeyframeView view{
        .motion = motion_between(ground_from_camera(keyframe), ground_from_camera(run.frame))};
    PlaneMotionStep noise = PlaneMotionStep::Zero();
    for (double& x : noise.head<6>()) x = normal(run.random);
    noise.head<3>() += displacement;
    view.motion = apply(view.motion, noise, view.tilt_axes);
    view.measured.covariance = kSigma * kSigma * Matrix6d::Identity();
    run.advance(run.features(), view);
    if (run.frame % kKeyframeInterval != 1) return;
    keyframe = run.frame - 1;
    run.window->take_ground_keyframe();
  }

  // Of the displacement from the first frame.
  [[nodiscard]] double error_m() const {
    const Eigen::Vector3d estimated =
        run.window->state().world_from_imu.translation - run.window->world_from_first().translation;
    return (estimated - run.truth().world_from_imu.translation +
            run.motion.state(0).world_from_imu.translation)
        .norm();
  }
  [[nodiscard]] double sigma_m() const {
    return std::sqrt(run.window->covariance().block<3, 3>(3, 3).trace());
  }

  WindowRun run;
  double true_height_m = 0;
  int keyframe = 0;  // of the ground
};

TEST(SlidingWindow, IsMetricFromTheSecondFrameAboveKnownGround) {
  FlightAboveGround flight(0);
  flight.run.step();
  flight.run.step();
  EXPECT_TRUE(flight.run.window->is_initialized());
  EXPECT_LT(flight.error_m(), 0.02);
}

TEST(SlidingWindow, FindsThatTheGroundIsAPlaneAndLevel) {
  FlightAboveGround flight(0);
  while (flight.run.frame < 200) flight.run.step();
  const std::optional<StartAboveGround>& start = flight.run.window->window().start;
  ASSERT_TRUE(start);
  EXPECT_TRUE(start->relief.is_plane());
  EXPECT_TRUE(start->is_level);
  EXPECT_LT(flight.error_m(), 4 * flight.sigma_m());
}

// A level ground that may slope more than any other takes nothing from the prior.
TEST(SlidingWindow, LevelGroundIsNoLessCertainThanASlope) {
  FlightAboveGround flight(0, 1, 0.2);
  while (flight.run.frame < 100) flight.run.step();
  const std::optional<StartAboveGround>& start = flight.run.window->window().start;
  ASSERT_TRUE(start);
  EXPECT_FALSE(start->is_level);
  EXPECT_LT(flight.error_m(), 4 * flight.sigma_m());
}

TEST(SlidingWindow, AlignmentsToTheGroundMakeTheMotionMoreAccurate) {
  FlightAboveGround by_points(0), aligned(0);
  double squared_by_points = 0, squared_aligned = 0;
  while (aligned.run.frame < 200) {
    by_points.run.step();
    aligned.step_aligned();
    squared_by_points += by_points.error_m() * by_points.error_m();
    squared_aligned += aligned.error_m() * aligned.error_m();
    if (aligned.run.frame < 10) continue;
    EXPECT_LT(aligned.error_m(), 4 * aligned.sigma_m()) << aligned.run.frame;
  }
  EXPECT_LT(aligned.sigma_m(), 0.9 * by_points.sigma_m());
  EXPECT_LT(squared_aligned, 0.8 * squared_by_points);
}

// An alignment by one period of a pattern off.
TEST(SlidingWindow, RejectsAnAlignmentToAnotherPlace) {
  FlightAboveGround flight(0);
  while (flight.run.frame < 100) flight.step_aligned();
  flight.step_aligned({0.05, 0, 0});
  const Window& window = flight.run.window->window();
  EXPECT_NE(window.alignments.back().frame_id, window.frames.back().id);
  flight.step_aligned();
  EXPECT_EQ(window.alignments.back().frame_id, window.frames.back().id);
  EXPECT_LT(flight.error_m(), 4 * flight.sigma_m());
}

// Only alignments from one keyframe of the ground to the next enter the prior.
TEST(SlidingWindow, KeepsAlignmentsWithinTheWindow) {
  FlightAboveGround flight(0);
  while (flight.run.frame < 150) flight.step_aligned();
  const Window& window = flight.run.window->window();
  EXPECT_TRUE(window.find(window.ground_keyframe_id));
  ASSERT_FALSE(window.alignments.empty());
  for (const GroundAlignment& alignment : window.alignments) {
    EXPECT_TRUE(window.find(alignment.keyframe_id));
    EXPECT_TRUE(window.find(alignment.frame_id));
  }
}

TEST(SlidingWindow, ImuCorrectsAWrongHeight) {
  FlightAboveGround flight(0, 1.1);
  while (flight.run.frame < 200) flight.run.step();
  const Window& window = flight.run.window->window();
  ASSERT_TRUE(window.start);
  EXPECT_NEAR(window.ground.height_m, 0.1 * flight.true_height_m, 0.02 * flight.true_height_m);
  EXPECT_LT(flight.error_m(), 4 * flight.sigma_m());
}

// The height that corrects itself after the start is the linearization point too.
TEST(SlidingWindow, LinearizationPointFollowsTheHeight) {
  FlightAboveGround flight(0, 1.1);
  while (flight.run.frame < 200) flight.run.step();
  const Window& window = flight.run.window->window();
  const Eigen::Vector2d below = window.frames.back().state.world_from_imu.translation.head<2>();
  const auto height_m = [&](const WindowGround& ground) {
    return ground.height_m + ground.slope.dot(below);
  };
  EXPECT_NEAR(height_m(window.first_ground), height_m(window.ground), 1e-4);
}

TEST(SlidingWindow, ForgetsAGroundThatIsNoPlane) {
  FlightAboveGround flight(2);
  while (flight.run.frame < 200) flight.run.step();
  EXPECT_TRUE(flight.run.window->is_initialized());
  EXPECT_FALSE(flight.run.window->window().start);
  EXPECT_LT(flight.error_m(), 4 * flight.sigma_m());
}

}  // namespace
}  // namespace stillkite
