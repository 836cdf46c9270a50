#include <gtest/gtest.h>

#include "estimation/plane/keyframe_pose.hpp"
#include "geometry/plane.hpp"
#include "tests/estimation/fusion/fusion_scene.hpp"

namespace stillkite {
namespace {

// Of a start whose height is known the flow's view gives the way in metres, whatever the camera has
// done meanwhile, and after a new keyframe again.
TEST(FusionFilter, TheGroundTellsTheWayInHeights) {
  FusionConfig config;
  config.height_sigma_ratio = config.scale_sigma_ratio = 1e-4;
  config.acceleration_density = 100;
  const RigidTransform start{so3_exp({2.9, 0.3, 0.1}), {1, 2, 4}};
  FusionFilter filter(config, {.world_from_camera = start, .velocity_sigma = 10});
  RigidTransform keyframe = start;
  for (const Eigen::Vector3d& way : {Eigen::Vector3d(0.1, -0.2, 0.15), {0.2, 0.1, 0.4}}) {
    const RigidTransform camera{so3_exp(0.02 * way) * keyframe.rotation,
                                keyframe.translation + way};
    filter.predict({.dt_s = 0.2, .angular_rate_rad_s = {}, .specific_force_m_s2 = {}});
    const RigidTransform camera_from_keyframe = camera.inverse() * keyframe;
    ASSERT_TRUE(filter.update_keyframe_view(
        view_of({.rotation = camera_from_keyframe.rotation,
                 .translation = camera_from_keyframe.translation / keyframe.translation.z(),
                 .normal = ground_plane_in_camera(keyframe).normal_in_camera},
                1e-4),
        1));
    const RigidTransform found = filter.world_from_camera_m();
    EXPECT_LT((found.translation - camera.translation).norm(), 0.005);
    EXPECT_LT(angle_between_rad(found.rotation, camera.rotation), 1e-3);
    filter.take_keyframe();
    keyframe = camera;
  }
}

// What a filter makes of the camera's way from a keyframe that stands askew over the ground.
struct Aside {
  FusionConfig config;
  double tilt_sigma_rad = 1e-4;
  RigidTransform keyframe{so3_exp({2.9, 0.3, 0.1}), {1, 2, 4}};
  RigidTransform camera{so3_exp({0.002, -0.004, 0.003}) * keyframe.rotation, {1.1, 1.8, 4.15}};
  TiltAxes tilt_axes = keyframe.rotation.conjugate().toRotationMatrix().leftCols<2>();

  Aside() {
    config.height_sigma_ratio = config.scale_sigma_ratio = 1e-4;
    config.acceleration_density = 100;
  }
  [[nodiscard]] KeyframeView view() const {
    KeyframeView view = view_of(motion_between(keyframe, camera), 1e-4);
    view.tilt_axes = tilt_axes;
    return view;
  }
  [[nodiscard]] FusionFilter seen(const KeyframeView& view) const {
    FusionFilter filter(
        config,
        {.world_from_camera = keyframe, .velocity_sigma = 10, .tilt_sigma_rad = tilt_sigma_rad});
    filter.predict({.dt_s = 0.2, .angular_rate_rad_s = {}, .specific_force_m_s2 = {}});
    EXPECT_TRUE(filter.update_keyframe_view(view, 1));
    return filter;
  }
};

// Windows that took the ground for askew say what they would have said of a level one.
TEST(FusionFilter, AViewByAWrongNormalTellsTheSameMotion) {
  Aside aside;
  KeyframeView view = aside.view();
  view.likelihood.motion_by_tilt << 0.3, -0.2, 0.1, 0.4, -0.1, 0.2, -0.6, 0.1, 0.2, 0.5, -0.3, 0.1;
  const Eigen::Vector2d askew(0.02, -0.03);
  PlaneMotionStep step;
  step << view.likelihood.motion_by_tilt * askew, askew;
  view.motion = apply(view.motion, step, view.tilt_axes);
  const RigidTransform found = aside.seen(view).world_from_camera_m();
  EXPECT_LT((found.translation - aside.camera.translation).norm(), 0.005);
  EXPECT_LT(angle_between_rad(found.rotation, aside.camera.rotation), 1e-3);
}

// ... and which ground suits them tells the vertical, in the directions that they know.
TEST(FusionFilter, TheNormalThatSuitsTheWindowsTellsTheVertical) {
  Aside aside;
  aside.tilt_sigma_rad = 0.05;
  const Eigen::Vector2d tilt(0.02, -0.03);  // of the vertical about the world's x and y
  KeyframeView view = aside.view();
  const double sigma = 1e-4;
  view.likelihood.tilt_information(0, 0) = 1 / square(sigma);
  view.likelihood.tilt_information_rad = view.likelihood.tilt_information * tilt;
  const FusionFilter filter = aside.seen(view);
  EXPECT_NEAR(filter.state().gravity_tilt_rad.x(), tilt.x(), 1e-3);
  EXPECT_NEAR(filter.state().gravity_tilt_rad.y(), 0, 1e-3);
}

// The step is the way since it began. At a speed known to s it is known to s dt and what a white
// acceleration adds, whatever was known of the place.
TEST(FusionFilter, KnowsTheLastStepAsWellAsTheSpeed) {
  const double sigma = 0.3, dt_s = 0.1;
  FusionConfig config;
  config.scale_sigma_ratio = 1e-9;
  FusionFilter filter(config, {.world_from_camera = {{}, {0, 0, 2}}, .velocity_sigma = sigma});
  const InertialStep step{.dt_s = dt_s, .angular_rate_rad_s = {}, .specific_force_m_s2 = {}};
  filter.predict(step);
  filter.begin_step();
  EXPECT_EQ(filter.step_m(), Eigen::Vector3d::Zero());
  EXPECT_LT(filter.step_covariance().norm(), 1e-12);
  filter.predict(step);
  const double of_acceleration = square(config.acceleration_density) * dt_s;
  const double variance = (square(sigma) + of_acceleration + of_acceleration / 3) * square(dt_s);
  EXPECT_LT((filter.step_covariance() - variance * Eigen::Matrix3d::Identity()).norm(), 1e-9);
}

}  // namespace
}  // namespace stillkite
