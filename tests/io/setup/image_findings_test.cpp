#include "io/setup/image_findings.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <random>
#include <vector>

namespace stillkite {
namespace {

cv::Mat white_texture(unsigned seed, double sigma_grey) {
  std::mt19937 random(seed);
  std::normal_distribution<float> noise(0, static_cast<float>(sigma_grey));
  cv::Mat image(400, 600, CV_32FC1);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) image.at<float>(y, x) = noise(random);
  }
  return image;
}

Frame frame_of(const cv::Mat& image, double mean_grey) {
  Frame frame;
  image.convertTo(frame.grey, CV_8UC1, 1, mean_grey);
  return frame;
}

// Standard deviation of 40 grey after the blur.
TEST(ImageFindings, BlurOfWhiteTextureIsItsSigma) {
  for (const double sigma_px : {1.5, 2.5, 4.0, 6.0}) {
    cv::Mat image;
    cv::GaussianBlur(white_texture(1, 40 * 2 * sigma_px * std::sqrt(std::numbers::pi)), image, {},
                     sigma_px);
    ImageStatistics statistics;
    statistics.add(frame_of(image, 128));
    EXPECT_NEAR(statistics.blur_px(), sigma_px, 0.05 * sigma_px);
    EXPECT_EQ(sharpness_finding(statistics).verdict,
              statistics.blur_px() <= 4 ? SetupVerdict::ok : SetupVerdict::doubtful);
  }
}

TEST(ImageFindings, ExposureCountsClippedPixels) {
  const auto finding = [](double mean_grey) {
    ImageStatistics statistics;
    statistics.add(frame_of(white_texture(2, 40), mean_grey));
    return exposure_finding(statistics);
  };
  EXPECT_EQ(finding(128).verdict, SetupVerdict::ok) << finding(128).text;
  // P(x >= 252.5) = P(z > 0.3125) = 0.377
  EXPECT_EQ(finding(240).verdict, SetupVerdict::doubtful);
  EXPECT_NEAR(finding(240).measured->value, 0.377, 0.01);
  EXPECT_EQ(finding(290).verdict, SetupVerdict::wrong) << finding(290).text;
  EXPECT_EQ(finding(-40).verdict, SetupVerdict::wrong) << finding(-40).text;
}

TEST(ImageFindings, TextureOfAGreyImageIsWrong) {
  ImageStatistics textured, grey;
  textured.add(frame_of(white_texture(3, 40), 128));
  grey.add(frame_of(white_texture(3, 0.5), 128));
  EXPECT_EQ(texture_finding(textured).verdict, SetupVerdict::ok);
  EXPECT_EQ(texture_finding(grey).verdict, SetupVerdict::wrong);
}

// Box blur along x of the displacement times the exposure ratio, over a smooth texture.
ImageGradients moved(double shift_px, double exposure_ratio, unsigned seed) {
  constexpr int kSteps = 8;
  cv::Mat texture, sum = cv::Mat::zeros(400, 600, CV_32FC1);
  cv::GaussianBlur(white_texture(seed, 400), texture, {}, 2.5);
  for (int i = 0; i < kSteps; ++i) {
    const double offset_px = shift_px * exposure_ratio * ((i + 0.5) / kSteps - 0.5);
    const cv::Mat M = (cv::Mat_<double>(2, 3) << 1, 0, offset_px, 0, 1, 0);
    cv::Mat part;
    cv::warpAffine(texture, part, M, texture.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT);
    sum += part / kSteps;
  }
  ImageGradients out = ImageStatistics::gradients(frame_of(sum, 128));
  out.shift_px = {shift_px, 0};
  return out;
}

TEST(ImageFindings, ExposureTimeByTheMotionBlur) {
  constexpr double kRatio = 0.2, kInterval_s = 0.04;
  std::vector<ImageGradients> frames;
  for (unsigned i = 0; i < 120; ++i) frames.push_back(moved(1 + i % 12, kRatio, i));
  const SetupFinding finding = shutter_finding(frames, kInterval_s);
  EXPECT_EQ(finding.verdict, SetupVerdict::ok) << finding.text;
  ASSERT_TRUE(finding.measured) << finding.text;
  EXPECT_NEAR(finding.measured->value, kRatio * 12, 0.15 * kRatio * 12) << finding.text;
}

TEST(ImageFindings, NoShutterFromTooFewImages) {
  std::vector<ImageGradients> frames;
  for (unsigned i = 0; i < 50; ++i) frames.push_back(moved(1 + i % 12, 0.2, i));
  EXPECT_EQ(shutter_finding(frames, 0.04).verdict, SetupVerdict::cannot_tell);
}

FrameStamps stamps_of(int count, int missing_every, double jitter_s) {
  FrameStamps out;
  for (int i = 0; i < count; ++i) {
    if (missing_every > 0 && i % missing_every == missing_every - 1) continue;
    out.filtered.push_back(from_seconds(0.04 * i));
    out.recorded.push_back(from_seconds(0.04 * i + (i % 2 == 0 ? jitter_s : -jitter_s)));
  }
  return out;
}

TEST(ImageFindings, FrameRateCountsMissingImagesAndJitter) {
  const SetupFinding regular = frame_rate_finding(stamps_of(200, 0, 0));
  EXPECT_EQ(regular.verdict, SetupVerdict::ok);
  EXPECT_NEAR(regular.measured->value, 25, 1e-9);
  EXPECT_EQ(frame_rate_finding(stamps_of(200, 10, 0)).verdict, SetupVerdict::doubtful);
  EXPECT_EQ(frame_rate_finding(stamps_of(200, 0, 0.004)).verdict, SetupVerdict::doubtful);
  EXPECT_EQ(frame_rate_finding(stamps_of(5, 0, 0)).verdict, SetupVerdict::cannot_tell);
}

TEST(ImageFindings, DisplacementIsDoubtfulAboveItsShareOfTheWidth) {
  EXPECT_EQ(displacement_finding(std::vector<double>(50, 90.0), 640).verdict, SetupVerdict::ok);
  EXPECT_EQ(displacement_finding(std::vector<double>(50, 100.0), 640).verdict,
            SetupVerdict::doubtful);
}

}  // namespace
}  // namespace stillkite
