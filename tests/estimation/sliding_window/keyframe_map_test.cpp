#include "estimation/sliding_window/keyframe_map.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "estimation/sliding_window/window_solver.hpp"
#include "true_window.hpp"

namespace stillkite {
namespace {

// Map of the first keyframe of a window at the truth, and a camera 0.5 m and 11 degrees away.
struct MapScene {
  MapScene() {
    for (const KeyframeMap::Point& known : map.points) {
      const InverseDepthPoint& point = known.point;
      const Eigen::Vector3d x =
          keyframe_from_camera.inverse() * (point.bearing.homogeneous() / point.inverse_depth);
      if (x.z() < 0.1) continue;
      const Eigen::Vector2d noise(sigma * normal(random), sigma * normal(random));
      features.push_back(
          {known.track_id, x.hnormalized() + noise, sigma * sigma * Eigen::Matrix2d::Identity()});
    }
  }
  [[nodiscard]] KeyframeMap exact_map() {
    std::vector<Eigen::Vector3d> points = points_in_view(HandHeldMotion{}, 100, random);
    const HandHeldMotion motion;
    KeyframeMap out;
    out.world_from_camera = motion.state(0).world_from_imu * motion.extrinsics.imu_from_camera;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector3d x = out.world_from_camera.inverse() * points[i];
      out.points.push_back(
          {static_cast<std::int64_t>(i), {x.hnormalized(), 1 / x.z()}, 1e-3 / x.z()});
    }
    return out;
  }

  double sigma = 5e-4;
  std::mt19937 random{8};
  std::normal_distribution<double> normal;
  RigidTransform keyframe_from_camera{so3_exp({0.1, -0.1, 0.12}), {0.3, -0.4, 0.1}};
  KeyframeMap map = exact_map();
  std::vector<FeatureObservation> features;
};

TEST(KeyframeMap, FindsTheCameraFromAFarGuess) {
  MapScene scene;
  const auto located = locate_camera(scene.map, scene.features, {});
  ASSERT_TRUE(located);
  Vector6d error;
  error << so3_log(located->keyframe_from_camera.rotation.conjugate() *
                   scene.keyframe_from_camera.rotation),
      scene.keyframe_from_camera.translation - located->keyframe_from_camera.translation;
  EXPECT_LT(error.norm(), 5e-3);
  EXPECT_LT(error.dot(located->covariance.ldlt().solve(error)), 38);
}

TEST(KeyframeMap, IgnoresFalseMatches) {
  MapScene scene;
  std::uniform_real_distribution<double> anywhere(-0.6, 0.6);
  for (std::size_t i = 0; i < scene.features.size(); i += 4) {
    scene.features[i].bearing = {anywhere(scene.random), anywhere(scene.random)};
  }
  const auto located = locate_camera(scene.map, scene.features, {});
  ASSERT_TRUE(located);
  const Eigen::Vector3d error_m =
      scene.keyframe_from_camera.translation - located->keyframe_from_camera.translation;
  EXPECT_LT(error_m.norm(), 1e-2);
}

TEST(KeyframeMap, IsNotFoundInAnotherPlace) {
  MapScene scene;
  std::uniform_real_distribution<double> anywhere(-0.6, 0.6);
  for (FeatureObservation& feature : scene.features) {
    feature.bearing = {anywhere(scene.random), anywhere(scene.random)};
  }
  EXPECT_FALSE(locate_camera(scene.map, scene.features, {}));
}

TEST(KeyframeMap, HasThePointsThatOtherImagesMeasured) {
  const Window window = true_window();
  const KeyframeMap map = keyframe_map(window, window.frames.front().id);
  ASSERT_GT(map.points.size(), 10U);
  for (const KeyframeMap::Point& known : map.points) {
    EXPECT_GT(known.inverse_depth_sigma, 0);
    EXPECT_LT(known.inverse_depth_sigma, known.point.inverse_depth);
  }
  EXPECT_TRUE(keyframe_map(window, 999).points.empty());
}

// Position and yaw are a choice: nothing that is measured depends on them.
TEST(MoveWindow, ChangesNoError) {
  Window window = true_window();
  window.frames[2].state.world_from_imu.translation += Eigen::Vector3d(0.01, -0.02, 0.03);
  window.frames[2].first_estimate = window.frames[2].state;
  // a prior that differs from axis to axis
  const int x = window.offsets()[2] + InertialIndex::kPosition;
  window.prior.information(x, x) += 1e6;
  window.prior.gradient[x] += 2e4;
  const double before = newton_decrement(window);
  ASSERT_GT(before, 1);
  const Eigen::Vector3d from = window.frames[3].state.world_from_imu.translation;
  move_window(window, so3_exp({0, 0, 0.7}), from, {3, -2, 5});
  EXPECT_NEAR(newton_decrement(window), before, 1e-6 * before);
  EXPECT_LT((window.frames[3].state.world_from_imu.translation - Eigen::Vector3d(3, -2, 5)).norm(),
            1e-12);
}

}  // namespace
}  // namespace stillkite
