#include "recording_images.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "codec_round_trip.hpp"

namespace stillkite::bench {
namespace {

constexpr int kWidth_px = 65;
constexpr int kHeight_px = 48;

// Grey g(x, y) = 20 + x + y + 4 i of 25 images at 10 Hz.
Recording ramp() {
  Recording recording;
  recording.camera = {.width_px = kWidth_px,
                      .height_px = kHeight_px,
                      .focal_x_px = 50,
                      .focal_y_px = 52,
                      .centre_x_px = 30,
                      .centre_y_px = 26};
  for (int i = 0; i < 25; ++i) {
    cv::Mat grey(kHeight_px, kWidth_px, CV_8UC1);
    for (int y = 0; y < grey.rows; ++y) {
      for (int x = 0; x < grey.cols; ++x) {
        grey.at<unsigned char>(y, x) = static_cast<unsigned char>(20 + x + y + 4 * i);
      }
    }
    recording.images.push_back({from_seconds(0.1 * i), grey});
  }
  return recording;
}

double mean_difference(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_L1) / static_cast<double>(a.total());
}

TEST(RecordingImages, HalfSizePixelsHaveTheGreyValueAtTheirRay) {
  const Recording recording = ramp();
  const Recording half = half_size(recording);
  EXPECT_EQ(half.images.front().grey.size(), cv::Size(32, 24));
  const Eigen::Vector2d at(7, 5);  // pixel of the half image
  const Eigen::Vector2d ray = undistort(half.camera, at).value();
  const Eigen::Vector2d full = distort(recording.camera, ray).pixel;
  const double expected = 20 + full.x() + full.y();
  EXPECT_NEAR(half.images.front().grey.at<unsigned char>(5, 7), expected, 0.51);
}

TEST(RecordingImages, GammaKeepsBlackAndWhite) {
  Recording recording = ramp();
  recording.images.front().grey.at<unsigned char>(0, 0) = 0;
  recording.images.front().grey.at<unsigned char>(0, 1) = 255;
  recording.images.front().grey.at<unsigned char>(0, 2) = 128;
  const cv::Mat grey = with_gamma(recording, 0.5).images.front().grey;
  EXPECT_EQ(grey.at<unsigned char>(0, 0), 0);
  EXPECT_EQ(grey.at<unsigned char>(0, 1), 255);
  EXPECT_EQ(grey.at<unsigned char>(0, 2), 181);  // 255 sqrt(128 / 255)
}

TEST(RecordingImages, NoiseHasItsSigmaAndDiffersBetweenImages) {
  const Recording recording = ramp();
  const Recording noisy = with_noise(recording, 6, 1);
  cv::Mat first, second, mean, sigma;
  cv::subtract(noisy.images[0].grey, recording.images[0].grey, first, cv::noArray(), CV_32F);
  cv::subtract(noisy.images[1].grey, recording.images[1].grey, second, cv::noArray(), CV_32F);
  cv::meanStdDev(first, mean, sigma);
  EXPECT_NEAR(mean.at<double>(0), 0, 6 * 4 / std::sqrt(first.total()));
  EXPECT_NEAR(sigma.at<double>(0), 6, 0.3);
  EXPECT_GT(cv::norm(first, second), 0);
}

TEST(RecordingImages, ExposureAlternatesEverySixthOfAShortRecording) {
  const Recording recording = ramp();  // 2.4 s: steps of 0.4 s
  const Recording stepped = with_exposure_steps(recording, 0.5);
  const auto corner = [](const RecordedImage& image) { return image.grey.at<unsigned char>(0, 0); };
  EXPECT_EQ(corner(stepped.images[3]), corner(recording.images[3]));
  EXPECT_EQ(corner(stepped.images[5]), corner(recording.images[5]) / 2);
  EXPECT_EQ(corner(stepped.images[9]), corner(recording.images[9]));
}

TEST(RecordingImages, JpegAndCodecsKeepImagesInTheirOrder) {
  const Recording recording = ramp();
  const std::vector<Recording> coded{with_jpeg(recording, 40), with_codec(recording, "libx264", 1),
                                     with_codec(recording, "libx265", 1)};
  for (const Recording& variant : coded) {
    ASSERT_EQ(variant.images.size(), recording.images.size());
    for (std::size_t i = 0; i < recording.images.size(); i += 6) {
      EXPECT_EQ(variant.images[i].stamp, recording.images[i].stamp);
      EXPECT_EQ(variant.images[i].grey.size(), recording.images[i].grey.size());
      // the next image differs by 4 grey
      EXPECT_LT(mean_difference(variant.images[i].grey, recording.images[i].grey), 2);
    }
  }
}

}  // namespace
}  // namespace stillkite::bench
