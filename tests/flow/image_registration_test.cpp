#include "flow/image_registration.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace stillkite {
namespace {

// Multi-scale noise: texture remains after downsampling.
cv::Mat multiscale_noise(int side_px) {
  cv::RNG random(7);
  cv::Mat sum = cv::Mat::zeros(side_px, side_px, CV_32F);
  for (int cell = 4; cell <= side_px / 8; cell *= 2) {
    cv::Mat noise(side_px / cell, side_px / cell, CV_32F);
    random.fill(noise, cv::RNG::NORMAL, 0, 12);
    cv::resize(noise, noise, sum.size(), 0, 0, cv::INTER_CUBIC);
    sum += noise;
  }
  cv::Mat grey;
  sum.convertTo(grey, CV_8U, 1, 128);
  return grey;
}

struct Motion {
  double x_px, y_px, rotation_deg;
};

class LargeMotion : public testing::TestWithParam<Motion> {};

TEST_P(LargeMotion, MeasuresLargeShiftAndRotation) {
  const Motion motion = GetParam();
  const cv::Size size(320, 240);
  const cv::Mat scene = multiscale_noise(1024);
  const cv::Point2f centre(511.5F, 511.5F);
  // OpenCV: positive angle from y to x
  cv::Mat matrix = cv::getRotationMatrix2D(centre, -motion.rotation_deg, 1);
  matrix.at<double>(0, 2) += motion.x_px;
  matrix.at<double>(1, 2) += motion.y_px;
  cv::Mat moved;
  cv::warpAffine(scene, moved, matrix, scene.size(), cv::INTER_CUBIC);
  const cv::Rect crop(352, 392, size.width, size.height);
  const auto registrations = register_images(scene(crop), moved(crop));
  ASSERT_FALSE(registrations.empty());
  EXPECT_NEAR(registrations[0].shift_px.x(), motion.x_px, 4);
  EXPECT_NEAR(registrations[0].shift_px.y(), motion.y_px, 4);
  EXPECT_NEAR(registrations[0].rotation_rad * 180 / CV_PI, motion.rotation_deg, 2.5);
  EXPECT_GT(registrations[0].correlation, 0.7);
}

INSTANTIATE_TEST_SUITE_P(ImageRegistration, LargeMotion,
                         testing::Values(Motion{0, 0, 0}, Motion{3, -2, 0}, Motion{40, 30, 0},
                                         Motion{-120, 10, 0}, Motion{20, 100, 0},
                                         Motion{-60, 40, 8}, Motion{10, -50, -10}));

TEST(ImageRegistration, TestsOnlyGivenRotations) {
  const cv::Mat scene = multiscale_noise(1024);
  const cv::Rect crop(300, 300, 320, 240);
  const auto registrations = register_images(scene(crop + cv::Point(-70, 30)), scene(crop),
                                             Eigen::Matrix3d::Identity(), kNoRotation_rad);
  ASSERT_FALSE(registrations.empty());
  EXPECT_NEAR(registrations[0].shift_px.x(), -70, 4);
  EXPECT_NEAR(registrations[0].shift_px.y(), 30, 4);
  for (const ImageRegistration& r : registrations) EXPECT_EQ(r.rotation_rad, 0);
}

TEST(ImageRegistration, ReturnsNothingWithoutTexture) {
  const cv::Mat grey(240, 320, CV_8UC1, cv::Scalar(90));
  EXPECT_TRUE(register_images(grey, grey).empty());
}

TEST(ImageRegistration, IsInvariantToExposure) {
  const cv::Mat scene = multiscale_noise(1024);
  const cv::Rect crop(100, 100, 320, 240);
  cv::Mat darker;
  scene.convertTo(darker, CV_8U, 0.6, 10);
  const auto registrations = register_images(scene(crop + cv::Point(50, 20)), darker(crop));
  ASSERT_FALSE(registrations.empty());
  EXPECT_NEAR(registrations[0].shift_px.x(), 50, 4);
  EXPECT_NEAR(registrations[0].shift_px.y(), 20, 4);
}

// Homography: scale 2 about the centre, which doubles the shift.
TEST(ImageRegistration, ReturnsShiftInPixelsOfHomography) {
  const cv::Mat scene = multiscale_noise(1024);
  const cv::Rect crop(300, 300, 320, 240);
  Eigen::Matrix3d homography = Eigen::Matrix3d::Identity();
  homography.topLeftCorner<2, 2>() *= 2;
  homography.topRightCorner<2, 1>() << -159.5, -119.5;
  const auto registrations =
      register_images(scene(crop + cv::Point(20, -10)), scene(crop), homography);
  ASSERT_FALSE(registrations.empty());
  EXPECT_NEAR(registrations[0].shift_px.x(), 40, 4);
  EXPECT_NEAR(registrations[0].shift_px.y(), -20, 4);
}

}  // namespace
}  // namespace stillkite
