#include "simulation/scene/moving_objects.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "simulation/camera_mount.hpp"
#include "simulation/render/patch_renderer.hpp"

namespace stillkite {
namespace {

// Forward camera at a height of 1.3 m: f / depth = 100 px per metre at 3 m.
constexpr Camera kForwardCamera{.width_px = 400,
                                .height_px = 300,
                                .focal_x_px = 300,
                                .focal_y_px = 300,
                                .centre_x_px = 199.5,
                                .centre_y_px = 149.5};
constexpr MovingObjectConfig kSingleObject{
    .count = 1, .distance_m = 3, .reach_m = 4, .speed_m_s = 0.5};

cv::Mat image_of(const PatchScene& scene) {
  const RigidTransform world_from_body{.translation = {0, 0, 1.3}};
  return PatchRenderer(kForwardCamera, 1)
      .render(scene, world_from_body * camera_raised_forward(90));
}

double left_m(const PatchScene& scene) {
  const Patch& patch = scene.patches.back();
  return (patch.corner_in_world_m + 0.5 * patch.right_in_world_m).y();
}

// Object of 0.6 m x 1.8 m at 3 m ahead, 0.4 m left: columns 200 - 70 to 200 - 10, rows 150 - 50 to
// 150 + 130.
TEST(MovingObjects, ChangeOnlyTheirProjection) {
  std::vector<MovingObject> moving_objects = make_moving_objects(kSingleObject, 1);
  ASSERT_EQ(moving_objects.size(), 1U);
  moving_objects[0].initial_path_m = 0;
  const PatchScene scene = with_moving_objects({}, kSingleObject, moving_objects, 0.8);
  EXPECT_NEAR(left_m(scene), 0.4, 1e-12);
  const cv::Mat changed = image_of(scene) != image_of({});
  const cv::Rect expected(130, 100, 60, 180);
  EXPECT_GT(cv::countNonZero(changed(expected)), 0.99 * expected.area());
  EXPECT_EQ(cv::countNonZero(changed), cv::countNonZero(changed(expected)));
}

TEST(MovingObjects, OccludeByDepth) {
  std::vector<MovingObject> far =
      make_moving_objects({.count = 1, .width_m = 4, .distance_m = 5}, 1);
  std::vector<MovingObject> near = make_moving_objects({.count = 1, .distance_m = 3}, 2);
  far[0].initial_path_m = near[0].initial_path_m = 0;
  const PatchScene both = with_moving_objects(with_moving_objects({}, {}, far, 0), {}, near, 0);
  const PatchScene both_reversed =
      with_moving_objects(with_moving_objects({}, {}, near, 0), {}, far, 0);
  const PatchScene alone = with_moving_objects({}, {}, near, 0);
  const cv::Rect near_object(172, 102, 56, 100);
  EXPECT_EQ(cv::countNonZero(image_of(both)(near_object) != image_of(alone)(near_object)), 0);
  EXPECT_EQ(cv::countNonZero(image_of(both) != image_of(both_reversed)), 0);
}

// 0.5 m/s, amplitude 4 m: period 32 s.
TEST(MovingObjects, FollowTriangleWave) {
  std::vector<MovingObject> moving_objects = make_moving_objects(kSingleObject, 1);
  moving_objects[0].initial_path_m = 0;
  const auto at = [&](double t_s) {
    return left_m(with_moving_objects({}, kSingleObject, moving_objects, t_s));
  };
  EXPECT_NEAR(at(0), 0, 1e-12);
  EXPECT_NEAR(at(3), 1.5, 1e-12);
  EXPECT_NEAR(at(8), 4, 1e-12);
  EXPECT_NEAR(at(10), 3, 1e-12);
  EXPECT_NEAR(at(24), -4, 1e-12);
  EXPECT_NEAR(at(33), 0.5, 1e-12);
}

TEST(MovingObjects, InitialPositionsDependOnSeed) {
  const std::vector<MovingObject> moving_objects = make_moving_objects({.count = 3}, 5);
  const std::vector<MovingObject> again = make_moving_objects({.count = 3}, 5);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(moving_objects[i].initial_path_m, again[i].initial_path_m);
    EXPECT_NEAR(moving_objects[i].at_centre.corner_in_world_m.x(),
                2.7 + 0.2 * static_cast<double>(i), 1e-12);
  }
  EXPECT_NE(moving_objects[0].initial_path_m, moving_objects[1].initial_path_m);
  EXPECT_NE(moving_objects[0].initial_path_m, make_moving_objects({}, 6)[0].initial_path_m);
}

}  // namespace
}  // namespace stillkite
