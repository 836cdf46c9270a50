#include "io/video/overlay.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/core.hpp>

#include "io/video/overlay_geometry.hpp"

namespace stillkite {
namespace {

const Camera kCamera{.width_px = 640,
                     .height_px = 480,
                     .focal_x_px = 500,
                     .focal_y_px = 510,
                     .centre_x_px = 320,
                     .centre_y_px = 235};

/// Camera along the world's x axis, pitched down by `down_rad`, then rolled about the optical axis.
Eigen::Quaterniond forward(double down_rad, double roll_rad = 0) {
  Eigen::Matrix3d R;  // columns: right, down, forward
  R << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return Eigen::Quaterniond(R) * so3_exp({-down_rad, 0, 0}) * so3_exp({0, 0, roll_rad});
}

const Eigen::Quaterniond kNadir(0, 1, 0, 0);

TEST(HorizonPixels, LieInPrincipalPointRowForLevelCamera) {
  const auto pixels = horizon_pixels(kCamera, forward(0));
  ASSERT_GT(pixels.size(), 10U);
  EXPECT_LT(pixels.front().x(), 20);
  EXPECT_GT(pixels.back().x(), 620);
  for (const auto& pixel : pixels) EXPECT_NEAR(pixel.y(), 235, 1e-9);
}

TEST(HorizonPixels, RiseByTangentOfCameraPitch) {
  for (const auto& pixel : horizon_pixels(kCamera, forward(0.2))) {
    EXPECT_NEAR(pixel.y(), 235 - 510 * std::tan(0.2), 1e-9);
  }
}

TEST(HorizonPixels, SlopeIsMinusTangentOfCameraRoll) {
  const auto pixels = horizon_pixels(kCamera, forward(0, 0.3));
  ASSERT_GT(pixels.size(), 2U);
  const Eigen::Vector2d run = pixels.back() - pixels.front();
  EXPECT_NEAR(run.y() / 510 / (run.x() / 500), std::tan(-0.3), 1e-9);
}

TEST(HorizonPixels, AreEmptyForHorizonOutsideImage) {
  EXPECT_TRUE(horizon_pixels(kCamera, kNadir).empty());
  EXPECT_TRUE(horizon_pixels(kCamera, forward(0.6)).empty());
}

// Strong barrel distortion: the polynomial folds distant points back into the image.
TEST(HorizonPixels, ExcludePointsOutsideValidRangeOfDistortion) {
  Camera camera = kCamera;
  camera.distortion = DistortionModel::radial_tangential;
  camera.coefficients = {-0.4733, 0.221};
  EXPECT_TRUE(horizon_pixels(camera, forward(1.2)).empty());
}

TEST(DirectionPixel, OpticalAxisMapsToPrincipalPoint) {
  const auto pixel = direction_pixel(kCamera, {0, 0, 3});
  ASSERT_TRUE(pixel);
  EXPECT_NEAR((*pixel - Eigen::Vector2d(320, 235)).norm(), 0, 1e-9);
}

TEST(DirectionPixel, NadirMovesByTangentOfTilt) {
  const Eigen::Quaterniond tilted = kNadir * so3_exp({0.1, 0, 0});
  const auto pixel = direction_pixel(kCamera, -(tilted.conjugate() * Eigen::Vector3d::UnitZ()));
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x(), 320, 1e-9);
  EXPECT_NEAR(pixel->y() - 235, 510 * std::tan(0.1), 1e-9);
}

TEST(DirectionPixel, IsNulloptOutsideImageAndForZeroVector) {
  EXPECT_FALSE(direction_pixel(kCamera, {0, 0, -1}));
  EXPECT_FALSE(direction_pixel(kCamera, {1, 0, 0.1}));
  EXPECT_FALSE(direction_pixel(kCamera, {0, 0, 0}));
}

TEST(Overlay, EnlargesSmallFramesToEvenSize) {
  Camera odd = kCamera;
  odd.width_px = 1241;
  odd.height_px = 375;
  EXPECT_EQ(Overlay(odd, {}).size(), cv::Size(1240, 374));
  EXPECT_EQ(Overlay(kCamera, {}).size(), cv::Size(1280, 960));
  const cv::Mat grey(375, 1241, CV_8UC1, cv::Scalar(90));
  Overlay overlay(odd, {});
  EXPECT_EQ(overlay.draw(grey, {}, {}).size(), overlay.size());
}

TEST(Overlay, DrawsNonFiniteEstimates) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr float kFloatNaN = std::numeric_limits<float>::quiet_NaN();
  NavigationEstimate estimate;
  estimate.twist_in_camera.velocity_m_s.setConstant(kNaN);
  estimate.velocity_in_world_m_s.setConstant(kNaN);
  estimate.world_from_body.rotation.coeffs().setConstant(kNaN);
  estimate.quality.mean_flow_px = kNaN;
  const std::vector<WeightedFlow> windows{
      {.centre_px = {kFloatNaN, 0}, .flow_px = {0, 0}},
      {.centre_px = {10, 10}, .flow_px = {kFloatNaN, 1e30F}},
      {.centre_px = {-1e20F, 1e20F}, .flow_px = {1, 1}, .weight = 0}};
  const cv::Mat grey(480, 640, CV_8UC1, cv::Scalar(90));
  Overlay overlay(kCamera, {});
  EXPECT_EQ(overlay.draw(grey, estimate, windows).type(), CV_8UC3);
}

}  // namespace
}  // namespace stillkite
