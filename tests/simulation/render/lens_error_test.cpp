#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "simulation/camera_mount.hpp"
#include "simulation/render/lens_error.hpp"
#include "simulation/render/patch_renderer.hpp"
#include "simulation/render/renderer.hpp"
#include "simulation/scene/fractal_noise.hpp"

namespace stillkite {
namespace {

const Camera kCamera{.width_px = 320,
                     .height_px = 240,
                     .focal_x_px = 250,
                     .focal_y_px = 250,
                     .centre_x_px = 159.5,
                     .centre_y_px = 119.5};

TEST(LensError, HasConfiguredRmsAndIsSmooth) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const LensError error = random_lens_error(kCamera, 0.3, seed);
    double square = 0;
    double steepest = 0;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (int row = 0; row < 240; ++row) {
      for (int column = 0; column < 320; ++column) {
        const Eigen::Vector2d here = error.at({column, row});
        square += here.squaredNorm();
        sum += here;
        steepest = std::max(steepest, (error.at({column + 1, row}) - here).norm());
      }
    }
    EXPECT_NEAR(std::sqrt(square / (320 * 240)), 0.3, 1e-9);
    EXPECT_LT(sum.norm() / (320 * 240), 1e-9);
    // nine terms of at most three half waves across 320 px
    EXPECT_LT(steepest, 3 * M_PI / 320 * 0.3 * 2 * 3);
  }
}

TEST(LensError, ShiftsPixelAgainstCalibration) {
  Camera camera = kCamera;
  camera.distortion = DistortionModel::radial_tangential;
  camera.coefficients = {-0.1, 0.02};
  const LensError error = random_lens_error(camera, 2, 5);
  const Eigen::Vector2d pixel(40, 200);
  const auto bearing = bearing_of(camera, error, pixel);
  ASSERT_TRUE(bearing);
  EXPECT_LT((distort(camera, *bearing).pixel - (pixel - error.at(pixel))).norm(), 1e-9);
}

// Reference: the image without error, resampled at p - e(p).
cv::Mat resampled(const cv::Mat& image, const LensError& error) {
  cv::Mat map(image.size(), CV_32FC2);
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.cols; ++column) {
      const Eigen::Vector2d from = Eigen::Vector2d(column, row) - error.at({column, row});
      map.at<cv::Vec2f>(row, column) = {static_cast<float>(from.x()), static_cast<float>(from.y())};
    }
  }
  cv::Mat out;
  cv::remap(image, out, map, {}, cv::INTER_CUBIC, cv::BORDER_REFLECT);
  return out;
}

double rms_inside(const cv::Mat& a, const cv::Mat& b) {
  const cv::Rect inside(8, 8, 304, 224);
  return cv::norm(a(inside), b(inside), cv::NORM_L2) / std::sqrt(inside.area());
}

TEST(LensError, EntersBothRenderers) {
  cv::Mat smooth;
  cv::GaussianBlur(fractal_noise(600, 600, 3), smooth, {}, 4);
  smooth.convertTo(smooth, CV_8UC1, 60, 128);
  const auto texture = std::make_shared<GroundTexture>(smooth, 0.1);
  const RigidTransform pose{camera_looking_down(), {0, 0, 25}};
  const LensError error = random_lens_error(kCamera, 3, 7);
  const Scene ground{.ground = texture};
  const cv::Mat exact = Renderer(kCamera, 1).render(ground, pose);
  const cv::Mat moved = Renderer(kCamera, 1, error).render(ground, pose);
  EXPECT_GT(rms_inside(moved, exact), 3);
  EXPECT_LT(rms_inside(moved, resampled(exact, error)), 0.3);

  const Patch patch{.corner_in_world_m = {-30, 30, 0},
                    .right_in_world_m = {60, 0, 0},
                    .down_in_world_m = {0, -60, 0},
                    .texture = texture};
  const PatchScene patches{.patches = {patch}};
  const cv::Mat exact_patch = PatchRenderer(kCamera, 1).render(patches, pose);
  const cv::Mat moved_patch = PatchRenderer(kCamera, 1, error).render(patches, pose);
  EXPECT_GT(rms_inside(moved_patch, exact_patch), 3);
  EXPECT_LT(rms_inside(moved_patch, resampled(exact_patch, error)), 0.3);
}

}  // namespace
}  // namespace stillkite
