#include "geometry/camera.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/geometry/sample_cameras.hpp"

namespace stillkite {
namespace {

class CameraTest : public testing::TestWithParam<SampleCamera> {
 protected:
  const Camera& camera = GetParam().camera;
};

INSTANTIATE_TEST_SUITE_P(Samples, CameraTest, testing::ValuesIn(sample_cameras()),
                         [](const auto& sample) { return sample.param.name; });

TEST_P(CameraTest, JacobianMatchesNumericDerivative) {
  constexpr double kStep = 1e-6;
  for (const Eigen::Vector2d& point : points_in_view(camera)) {
    Eigen::Matrix2d numeric;
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::Vector2d d = kStep * Eigen::Vector2d::Unit(axis);
      numeric.col(axis) =
          (distort(camera, point + d).pixel - distort(camera, point - d).pixel) / (2 * kStep);
    }
    const Eigen::Matrix2d jacobian = distort(camera, point).jacobian;
    EXPECT_LT((jacobian - numeric).norm(), 1e-8 * jacobian.norm()) << point.transpose();
  }
}

TEST_P(CameraTest, UndistortInvertsDistort) {
  for (const Eigen::Vector2d& point : points_in_view(camera)) {
    const std::optional<Eigen::Vector2d> undistorted =
        undistort(camera, distort(camera, point).pixel);
    ASSERT_TRUE(undistorted) << point.transpose();
    EXPECT_LT((*undistorted - point).norm(), 1e-13) << point.transpose();
  }
}

TEST_P(CameraTest, DistortInvertsUndistortOverTheImage) {
  for (int y = 0; y < camera.height_px; y += 16) {
    for (int x = 0; x < camera.width_px; x += 16) {
      const Eigen::Vector2d pixel(x, y);
      const std::optional<Eigen::Vector2d> point = undistort(camera, pixel);
      ASSERT_TRUE(point) << pixel.transpose();
      EXPECT_LT((distort(camera, *point).pixel - pixel).norm(), 1e-6) << pixel.transpose();
    }
  }
}

TEST_P(CameraTest, HalfResolutionMatchesMeanOf2x2Pixels) {
  const Camera half = half_resolution(camera);
  EXPECT_EQ(half.width_px, camera.width_px / 2);
  EXPECT_EQ(half.height_px, camera.height_px / 2);
  for (const Eigen::Vector2d& point : points_in_view(camera)) {
    // pixel (u, v) at half resolution is the centre of pixels (2u, 2v) to (2u + 1, 2v + 1)
    const Eigen::Vector2d pixel = distort(camera, point).pixel;
    const Eigen::Vector2d in_half = distort(half, point).pixel;
    EXPECT_LT((2.0 * in_half + Eigen::Vector2d(0.5, 0.5) - pixel).norm(), 1e-10);
  }
}

TEST(Camera, ProjectsAsPinholeWithoutDistortion) {
  const Camera camera{.width_px = 640,
                      .height_px = 480,
                      .focal_x_px = 500,
                      .focal_y_px = 400,
                      .centre_x_px = 320,
                      .centre_y_px = 240};
  const std::optional<Eigen::Vector2d> pixel = project(camera, {1, -2, 10});
  ASSERT_TRUE(pixel);
  EXPECT_TRUE(pixel->isApprox(Eigen::Vector2d(370, 160), 1e-15));
  EXPECT_TRUE(undistort(camera, *pixel)->isApprox(Eigen::Vector2d(0.1, -0.2), 1e-15));
}

TEST(Camera, ProjectsNoPointAtOrBehindItsPlane) {
  const Camera camera = sample_cameras().front().camera;
  EXPECT_FALSE(project(camera, {1, 1, 0}));
  EXPECT_FALSE(project(camera, {0, 0, -1}));
  EXPECT_FALSE(project(camera, {0, 0, std::nan("")}));
}

TEST(Camera, RejectsPixelsBeyondFoldOfDistortion) {
  // r (1 - r^2) is at most 2 / (3 sqrt 3) = 0.385
  Camera camera{.width_px = 640,
                .height_px = 480,
                .focal_x_px = 500,
                .focal_y_px = 500,
                .centre_x_px = 320,
                .centre_y_px = 240,
                .distortion = DistortionModel::radial_tangential,
                .coefficients = {-1.0}};
  EXPECT_TRUE(undistort(camera, {320 + 500 * 0.38, 240}));
  EXPECT_FALSE(undistort(camera, {320 + 500 * 0.39, 240}));
  EXPECT_FALSE(undistort(camera, {320 + 500 * 3.0, 240}));
}

}  // namespace
}  // namespace stillkite
