#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "geometry/angle.hpp"
#include "simulation/camera_mount.hpp"
#include "simulation/render/develop.hpp"
#include "simulation/render/patch_renderer.hpp"
#include "simulation/scene/scenes.hpp"

namespace stillkite {
namespace {

const Camera kCamera{.width_px = 800,
                     .height_px = 480,
                     .focal_x_px = 480,
                     .focal_y_px = 480,
                     .centre_x_px = 399.5,
                     .centre_y_px = 239.5};

// Initial camera pose of a trial: height 3 m, 15 degrees below the horizontal.
RigidTransform initial_pose() {
  return RigidTransform{.translation = {0, 0, 3}} * camera_raised_forward(75);
}

cv::Mat noisy_image_of(const PatchScene& scene) {
  return develop(PatchRenderer(kCamera, 2).render(scene, initial_pose()), {.noise_grey = 2}, 1);
}

int corner_count(const cv::Mat& image) {
  std::vector<cv::Point2f> corners;
  cv::goodFeaturesToTrack(image, corners, 10000, 0.01, 2, {}, 3);
  return static_cast<int>(corners.size());
}

TEST(Scenes, HaveTrackableCornersInInitialView) {
  const cv::Mat room = noisy_image_of(make_room(1));
  EXPECT_GT(corner_count(room), 1500);
  for (int row = 0; row < 480; row += 80) {
    for (int column = 0; column < 800; column += 80) {
      EXPECT_GT(corner_count(room(cv::Rect(column, row, 80, 80))), 10) << column << ", " << row;
    }
  }
  EXPECT_GT(corner_count(noisy_image_of(make_coast(1))), 1500);
}

TEST(Scenes, AreDeterministicInSeedWithDistinctTextures) {
  const PatchScene room = make_room(1);
  const auto has_same_texture = [](const Patch& a, const Patch& b) {
    return std::equal(a.texture->pairs(), a.texture->pairs() + 128, b.texture->pairs());
  };
  for (std::size_t k = 0; k < room.patches.size(); ++k) {
    for (std::size_t other = 0; other < k; ++other) {
      ASSERT_FALSE(has_same_texture(room.patches[k], room.patches[other])) << k << ", " << other;
    }
  }
  const cv::Mat image = noisy_image_of(room);
  EXPECT_EQ(cv::norm(image, noisy_image_of(make_room(1)), cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(image, noisy_image_of(make_room(2)), cv::NORM_L1) / (800 * 480), 10);
}

// From the centre, a closed room has a wall in every direction, not farther than its corners.
TEST(Scenes, RoomIsClosedAndHasDepth) {
  const PatchScene room = make_room(1);
  double nearest_ahead_m = 1e9;
  double farthest_ahead_m = 0;
  for (double yaw_deg = -180; yaw_deg < 180; yaw_deg += 3) {
    for (double pitch_deg = -87; pitch_deg < 90; pitch_deg += 3) {
      const Eigen::Vector3d direction(std::cos(pitch_deg * kDegree) * std::cos(yaw_deg * kDegree),
                                      std::cos(pitch_deg * kDegree) * std::sin(yaw_deg * kDegree),
                                      std::sin(pitch_deg * kDegree));
      const std::optional<double> depth = depth_at(room, {{0, 0, 3}, direction});
      ASSERT_TRUE(depth) << yaw_deg << ", " << pitch_deg;
      ASSERT_LT(*depth, std::hypot(6, 5, 3));
      if (std::abs(yaw_deg) > 30 || std::abs(pitch_deg) > 25) continue;
      nearest_ahead_m = std::min(nearest_ahead_m, *depth);
      farthest_ahead_m = std::max(farthest_ahead_m, *depth);
    }
  }
  EXPECT_LT(nearest_ahead_m, 4.5);
  EXPECT_GT(farthest_ahead_m, 5.9);
}

// The sea extends to a horizon at camera height.
TEST(Scenes, CoastHasHorizon) {
  const PatchScene coast = make_coast(1);
  const auto depth_towards = [&](double z) {
    return depth_at(coast, {{0, 0, 3}, Eigen::Vector3d(0.3, 1, z)});
  };
  EXPECT_NEAR(*depth_towards(-0.001), 3000, 1);
  EXPECT_NEAR(*depth_towards(0.1), 4970, 1);  // clouds at 500 m
  EXPECT_FALSE(depth_towards(1e-6));
}

}  // namespace
}  // namespace stillkite
