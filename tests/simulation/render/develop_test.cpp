#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "simulation/render/develop.hpp"

namespace stillkite {
namespace {

// Noise of a uniform image, in grey values.
cv::Mat noise_of(double deviation, std::uint64_t seed) {
  const cv::Mat even(500, 701, CV_32FC1, cv::Scalar(128));
  cv::Mat noise;
  develop(even, {.noise_grey = deviation}, seed).convertTo(noise, CV_64FC1, 1, -128);
  return noise;
}

double correlation(const cv::Mat& a, const cv::Mat& b) {
  return a.dot(b) / std::sqrt(a.dot(a) * b.dot(b));
}

TEST(Develop, NoiseHasConfiguredVarianceAndKurtosis) {
  const cv::Mat noise = noise_of(10, 5);
  const double count = static_cast<double>(noise.total());
  const double variance = noise.dot(noise) / count;
  const cv::Mat square = noise.mul(noise);
  EXPECT_NEAR(cv::sum(noise)[0] / count, 0, 4 * 10 / std::sqrt(count));
  EXPECT_NEAR(variance, 100 + 1.0 / 12, 1.0);
  // kurtosis of a sum of eight uniform variables: 3 - 1.2 / 8
  EXPECT_NEAR(square.dot(square) / count / (variance * variance), 2.85, 0.03);
}

// Variance of read noise, photon noise of the signal and quantization.
TEST(Develop, PhotonNoiseGrowsWithSignal) {
  for (const float irradiance : {20.0F, 80.0F}) {
    const cv::Mat even(500, 700, CV_32FC1, cv::Scalar(irradiance));
    cv::Mat grey;
    develop(even, {.gain = 2, .noise_grey = 3, .photon_variance_per_grey = 0.4}, 5)
        .convertTo(grey, CV_64FC1, 1, -2 * irradiance);
    const double count = static_cast<double>(grey.total());
    EXPECT_NEAR(cv::sum(grey)[0] / count, 0, 0.05);
    const double variance = 9 + 0.4 * 2 * irradiance + 1.0 / 12;
    EXPECT_NEAR(grey.dot(grey) / count, variance, 0.01 * variance);
  }
}

TEST(Develop, NoiseIsIndependentBetweenPixelsAndImages) {
  const cv::Mat noise = noise_of(10, 5);
  const double limit = 4.5 / std::sqrt(static_cast<double>(noise.total()));
  for (int dx = 0; dx <= 17; ++dx) {
    for (int dy = 0; dy <= 2; ++dy) {
      if (dx == 0 && dy == 0) continue;
      const cv::Mat here = noise(cv::Rect(0, 0, noise.cols - dx, noise.rows - dy)).clone();
      const cv::Mat there = noise(cv::Rect(dx, dy, here.cols, here.rows)).clone();
      EXPECT_LT(std::abs(correlation(here, there)), limit) << dx << ", " << dy;
    }
  }
  for (std::uint64_t seed = 6; seed < 12; ++seed) {
    EXPECT_LT(std::abs(correlation(noise, noise_of(10, seed))), limit) << seed;
  }
}

TEST(Develop, IsDeterministicInSeed) {
  EXPECT_EQ(cv::norm(noise_of(3, 9), noise_of(3, 9), cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(noise_of(3, 9), noise_of(3, 10), cv::NORM_INF), 0);
}

TEST(Develop, AppliesGainRoundsAndSaturates) {
  cv::Mat ramp(1, 301, CV_32FC1);
  for (int k = 0; k < ramp.cols; ++k) ramp.at<float>(0, k) = static_cast<float>(k) - 20.25F;
  const cv::Mat grey = develop(ramp, {.gain = 1.3}, 1);
  for (int k = 0; k < ramp.cols; ++k) {
    const double exact = std::clamp(1.3 * (k - 20.25), 0.0, 255.0);
    EXPECT_LE(std::abs(grey.at<std::uint8_t>(0, k) - exact), 0.5 + 1e-4) << k;
  }
}

}  // namespace
}  // namespace stillkite
