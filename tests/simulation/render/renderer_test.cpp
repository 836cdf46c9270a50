#include <gtest/gtest.h>

#include <hwy/targets.h>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "geometry/angle.hpp"
#include "geometry/euler.hpp"
#include "simulation/camera_mount.hpp"
#include "simulation/render/renderer.hpp"
#include "simulation/scene/procedural_ground.hpp"
#include "tests/simulation/render/ground_truth.hpp"

namespace stillkite {
namespace {

using test::ground_point;
using test::small_camera;

std::shared_ptr<const GroundTexture> smooth_ground(double metres_per_texel) {
  cv::Mat grey = procedural_ground(600, 420, 7);
  cv::GaussianBlur(grey, grey, {}, 1.5);
  return std::make_shared<GroundTexture>(grey, metres_per_texel);
}

RigidTransform tilted(double yaw_deg, double pitch_deg, double roll_deg,
                      const Eigen::Vector3d& position) {
  return {to_quaternion({yaw_deg * kDegree, pitch_deg * kDegree, roll_deg * kDegree}) *
              camera_looking_down(),
          position};
}

struct ViewCase {
  const char* name;
  DistortionModel lens;
  bool relief;
  RigidTransform world_from_camera;
};

class GroundProjection : public testing::TestWithParam<ViewCase> {};

// A pixel has the grey value of its ground point.
TEST_P(GroundProjection, MatchesGroundTexture) {
  const ViewCase& view = GetParam();
  const Camera camera = small_camera(view.lens);
  const double texel_m = 0.9;
  const Scene scene{
      .ground = smooth_ground(texel_m),
      .relief = view.relief ? std::make_shared<Relief>(ReliefConfig{5, 50}, 3) : nullptr};
  const cv::Mat image = Renderer(camera, 1).render(scene, view.world_from_camera);
  Random random(11);
  int compared = 0;
  for (int k = 0; k < 4000; ++k) {
    const int column = static_cast<int>(random.uniform(0, camera.width_px));
    const int row = static_cast<int>(random.uniform(0, camera.height_px));
    const auto point = ground_point(camera, view.world_from_camera, scene.relief.get(),
                                    {double(column), double(row)});
    if (!point) continue;
    const Eigen::Vector3d in_camera = view.world_from_camera.inverse() * *point;
    ASSERT_LT((*project(camera, in_camera) - Eigen::Vector2d(column, row)).norm(), 1e-6);
    // distant ground is averaged
    const double footprint =
        in_camera.z() * in_camera.z() / view.world_from_camera.translation.z() / 168.0 / texel_m;
    if (footprint > 1) continue;
    ++compared;
    ASSERT_NEAR(image.at<float>(row, column), scene.ground->grey_at(point->head<2>()),
                view.relief ? 0.25 : 0.05)
        << "at " << column << ", " << row;
  }
  EXPECT_GT(compared, 1000);
}

INSTANTIATE_TEST_SUITE_P(
    Renderer, GroundProjection,
    testing::Values(
        ViewCase{"nadir", DistortionModel::none, false, tilted(0, 0, 0, {3, -8, 100})},
        ViewCase{"tilted", DistortionModel::none, false, tilted(30, 20, -15, {40, 25, 100})},
        ViewCase{"lens", DistortionModel::radial_tangential, false, tilted(-50, 5, 8, {1, 2, 90})},
        ViewCase{"fisheye", DistortionModel::equidistant, false, tilted(170, -8, 3, {0, 0, 90})},
        // mirrored repetition of the texture, far from the origin
        ViewCase{"mirrored", DistortionModel::none, false,
                 tilted(70, -10, 5, {20345.6, -9876.5, 100})},
        ViewCase{"relief", DistortionModel::none, true, tilted(20, 10, 6, {10, 20, 100})},
        ViewCase{"relief_lens", DistortionModel::radial_tangential, true,
                 tilted(-20, 4, -6, {5012.3, -777.7, 110})}),
    [](const auto& view) { return view.param.name; });

TEST(Renderer, AveragesSamplesOfPixel) {
  const Camera camera = small_camera();
  const Scene scene{.ground = smooth_ground(0.9)};
  const RigidTransform pose = tilted(10, 5, -3, {0, 0, 100});
  const cv::Mat image = Renderer(camera, 2).render(scene, pose);
  for (int k = 0; k < 200; ++k) {
    const int column = 1 + k;
    const int row = 20 + k % 100;
    double mean = 0;
    for (const double right : {-0.25, 0.25}) {
      for (const double down : {-0.25, 0.25}) {
        mean += 0.25 *
                scene.ground->grey_at(
                    ground_point(camera, pose, nullptr, {column + right, row + down})->head<2>());
      }
    }
    ASSERT_NEAR(image.at<float>(row, column), mean, 0.05);
  }
}

// Homography between two images of a plane: H = dR + t n^T / h.
TEST(Renderer, ImagesOfPlaneAreRelatedByHomography) {
  const Camera camera = small_camera();
  const Scene scene{.ground = smooth_ground(1.6)};
  const RigidTransform first = tilted(10, 5, -3, {0, 0, 100});
  const RigidTransform second = tilted(12, 3, -2, {4, -2, 97});
  const Renderer renderer(camera, 2);
  const cv::Mat a = renderer.render(scene, first);
  const cv::Mat b = renderer.render(scene, second);

  const RigidTransform second_from_first = second.inverse() * first;
  const Eigen::Vector3d n = -(first.rotation.conjugate() * Eigen::Vector3d::UnitZ());
  const Eigen::Matrix3d H = second_from_first.rotation.toRotationMatrix() +
                            second_from_first.translation * n.transpose() / first.translation.z();
  cv::Mat map_x(a.size(), CV_32FC1);
  cv::Mat map_y(a.size(), CV_32FC1);
  for (int row = 0; row < a.rows; ++row) {
    for (int column = 0; column < a.cols; ++column) {
      const Eigen::Vector2d bearing = *undistort(camera, {double(column), double(row)});
      const Eigen::Vector2d to = *project(camera, H * bearing.homogeneous());
      map_x.at<float>(row, column) = static_cast<float>(to.x());
      map_y.at<float>(row, column) = static_cast<float>(to.y());
    }
  }
  cv::Mat warped;
  cv::remap(b, warped, map_x, map_y, cv::INTER_CUBIC);
  const cv::Rect inside(30, 30, a.cols - 60, a.rows - 60);
  const double rms = cv::norm(a(inside), warped(inside), cv::NORM_L2) / std::sqrt(inside.area());
  const double rms_unwarped =
      cv::norm(a(inside), b(inside), cv::NORM_L2) / std::sqrt(inside.area());
  EXPECT_LT(rms, 0.25);
  EXPECT_GT(rms_unwarped, 5);
}

TEST(Renderer, RendersSkyAboveHorizonAndAveragesDistantGround) {
  const Camera camera = small_camera();
  cv::Mat checkers(256, 256, CV_8UC1);
  for (int v = 0; v < 256; ++v) {
    for (int u = 0; u < 256; ++u) checkers.at<std::uint8_t>(v, u) = (u + v) % 2 ? 200 : 40;
  }
  const Scene scene{.ground = std::make_shared<GroundTexture>(checkers, 0.2), .sky_grey = 230};
  // pitch of -90 degrees: horizontal optical axis
  const cv::Mat image = Renderer(camera, 2).render(scene, tilted(0, -90, 0, {0, 0, 50}));
  for (int column = 0; column < camera.width_px; column += 7) {
    for (int row = 0; row < 80; ++row) ASSERT_EQ(image.at<float>(row, column), 230.0F);
    for (int row = 83; row < camera.height_px; ++row) {
      ASSERT_NEAR(image.at<float>(row, column), 120, 12);
    }
  }
}

TEST(Renderer, RendersVehicleAtItsPosition) {
  const Camera camera = small_camera();
  const cv::Mat white(8, 16, CV_8UC1, cv::Scalar(255));
  const cv::Mat black(300, 300, CV_8UC1, cv::Scalar(0));
  const Scene scene{.ground = std::make_shared<GroundTexture>(black, 1.0),
                    .vehicle = std::make_shared<GroundTexture>(white, 1.0)};
  const RigidTransform pose = tilted(25, 8, -4, {0, 0, 100});
  const VehiclePlacement vehicle{{6, -9}, 0.7, 30, 12};
  const cv::Mat image = Renderer(camera, 1).render(scene, pose, {.vehicle = vehicle});
  const Eigen::Rotation2Dd vehicle_from_world(-vehicle.heading_rad);
  for (int row = 0; row < camera.height_px; ++row) {
    for (int column = 0; column < camera.width_px; ++column) {
      const auto point = ground_point(camera, pose, nullptr, {double(column), double(row)});
      const Eigen::Vector2d at =
          vehicle_from_world * (point->head<2>() - vehicle.centre_in_world_m);
      const double edge = std::max(std::abs(at.x()) - 15, std::abs(at.y()) - 6);
      if (std::abs(edge) < 1e-3) continue;
      ASSERT_EQ(image.at<float>(row, column), edge < 0 ? 255.0F : 0.0F);
    }
  }
}

TEST(Renderer, IsDeterministicAndIndependentOfVectorWidth) {
  const Scene scene{.ground = smooth_ground(0.9),
                    .relief = std::make_shared<Relief>(ReliefConfig{3, 50}, 3)};
  const RigidTransform pose = tilted(20, 30, 6, {10, 20, 100});
  const Renderer renderer(small_camera(), 2);
  const cv::Mat once = renderer.render(scene, pose);
  EXPECT_EQ(cv::norm(once, renderer.render(scene, pose), cv::NORM_INF), 0);

  hwy::DisableTargets(~std::int64_t{HWY_STATIC_TARGET});
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  const cv::Mat narrow = renderer.render(scene, pose);
  hwy::DisableTargets(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  EXPECT_LT(cv::norm(once, narrow, cv::NORM_INF), 0.05);
}

}  // namespace
}  // namespace stillkite
