#include "flow/standstill_detector.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

namespace stillkite {
namespace {

const cv::Size kImage(640, 480);
constexpr double kFrames_hz = 25;
constexpr int kFrames = 50;
constexpr int kFirstAtRest = 13;  // 0.5 s

// Multi-scale noise of standard deviation `contrast` in grey.
cv::Mat texture(double contrast) {
  cv::RNG random(7);
  cv::Mat sum = cv::Mat::zeros(600, 800, CV_32F);
  for (int cell = 3; cell <= 48; cell *= 2) {
    cv::Mat noise(600 / cell, 800 / cell, CV_32F);
    random.fill(noise, cv::RNG::NORMAL, 0, contrast / 2);
    cv::resize(noise, noise, sum.size(), 0, 0, cv::INTER_CUBIC);
    sum += noise;
  }
  cv::Mat grey;
  sum.convertTo(grey, CV_8U, 1, 128);
  return grey;
}

struct View {
  cv::Point2d displacement_px;
  double turn_rad = 0;
  double zoom = 1;
  double gain = 1;
};

cv::Mat camera_image(const cv::Mat& scene, const View& view, double noise_grey, int seed) {
  cv::Mat image;
  cv::Mat warp = cv::getRotationMatrix2D({400, 300}, view.turn_rad * 180 / CV_PI, view.zoom);
  warp.at<double>(0, 2) += view.displacement_px.x - 80;
  warp.at<double>(1, 2) += view.displacement_px.y - 60;
  cv::warpAffine(scene, image, warp, kImage, cv::INTER_CUBIC);
  cv::Mat noise(image.size(), CV_32F), noisy;
  cv::RNG random(static_cast<std::uint64_t>(seed) + 1);
  random.fill(noise, cv::RNG::NORMAL, 0, noise_grey);
  image.convertTo(noisy, CV_32F, view.gain);
  noisy += noise;
  noisy.convertTo(image, CV_8U);
  return image;
}

using Draw = std::function<void(cv::Mat&, int)>;

/// Speed sigmas of a sequence; NaN: not at rest.
std::vector<double> speed_sigmas(const std::function<View(int)>& view, double contrast = 30,
                                 double noise_grey = 2, const Draw& draw = {}) {
  const cv::Mat scene = texture(contrast);
  StandstillDetector detector;
  std::vector<double> out;
  for (int i = 0; i < kFrames; ++i) {
    cv::Mat grey = camera_image(scene, view(i), noise_grey, i);
    if (draw) draw(grey, i);
    const Frame frame{from_seconds(i / kFrames_hz), i, grey};
    const std::optional<Standstill> standstill = detector.update(frame);
    out.push_back(standstill ? standstill->speed_px_s : NAN);
  }
  return out;
}

int frames_at_rest(const std::vector<double>& sigmas) {
  return static_cast<int>(
      std::count_if(sigmas.begin(), sigmas.end(), [](double s) { return !std::isnan(s); }));
}

View at_rest(int) {
  return {};
}

TEST(StandstillDetector, DetectsRestAfterHalfASecond) {
  const std::vector<double> sigmas = speed_sigmas(at_rest);
  for (int i = 0; i < kFrames; ++i) {
    const double sigma = sigmas[static_cast<std::size_t>(i)];
    EXPECT_EQ(std::isnan(sigma), i < kFirstAtRest) << i;
    if (i < kFirstAtRest) continue;
    EXPECT_GT(sigma, 0);
    EXPECT_LT(sigma, 1) << "px/s";
  }
}

TEST(StandstillDetector, SpeedSigmaGrowsWithTheNoiseOfTheImages) {
  const double quiet = speed_sigmas(at_rest, 30, 2).back();
  const double noisy = speed_sigmas(at_rest, 60, 20).back();
  EXPECT_GT(noisy, 2 * quiet);
  EXPECT_LT(noisy, 3);
}

// Sigma covers a shake that stays within the limit: 0.1 px amplitude of 2 Hz.
TEST(StandstillDetector, SpeedSigmaCoversShaking) {
  constexpr double kRate = 2 * CV_PI * 2;
  const auto sigmas = speed_sigmas([](int i) {
    return View{.displacement_px = {0.1 * std::sin(kRate * i / kFrames_hz), 0}};
  });
  EXPECT_GT(frames_at_rest(sigmas), 0);
  EXPECT_GT(sigmas.back(), 0.7 * 0.1 * kRate * std::sqrt(0.5));
}

TEST(StandstillDetector, SlowMotionIsNoRest) {
  constexpr double kSlow_px_s = 1.5;
  const auto t = [](int i) { return i / kFrames_hz; };
  EXPECT_EQ(frames_at_rest(speed_sigmas([&](int i) {
              return View{.displacement_px = {kSlow_px_s * t(i), 0}};
            })),
            0);
  EXPECT_EQ(frames_at_rest(speed_sigmas([&](int i) { return View{.turn_rad = 0.01 * t(i)}; })), 0);
  EXPECT_EQ(frames_at_rest(speed_sigmas([&](int i) { return View{.zoom = 1 + 0.01 * t(i)}; })), 0);
}

TEST(StandstillDetector, ExposureDoesNotMove) {
  const auto sigmas = speed_sigmas([](int i) { return View{.gain = i % 10 < 5 ? 1 : 0.7}; });
  EXPECT_EQ(frames_at_rest(sigmas), kFrames - kFirstAtRest);
}

// A person walks through the image.
TEST(StandstillDetector, MovingObjectsDoNotMoveTheCamera) {
  const auto sigmas = speed_sigmas(at_rest, 30, 2, [](cv::Mat& grey, int i) {
    const cv::Rect person(20 + 8 * i, 200, 80, 200);
    texture(40)(cv::Rect(0, 0, 80, 200)).copyTo(grey(person));
  });
  EXPECT_EQ(frames_at_rest(sigmas), kFrames - kFirstAtRest);
}

// Landing gear in view of a camera over weak texture.
TEST(StandstillDetector, StaticOverlayIsNoRest) {
  const auto sigmas = speed_sigmas(
      [](int i) {
        return View{.displacement_px = {0.4 * i, 0}};
      },
      6, 2,
      [](cv::Mat& grey, int) {
        for (int x = 0; x < 160; x += 20) cv::line(grey, {x, 0}, {x / 2, 480}, 255, 4);
      });
  EXPECT_EQ(frames_at_rest(sigmas), 0);
}

TEST(StandstillDetector, NothingToSeeIsNoRest) {
  EXPECT_EQ(frames_at_rest(speed_sigmas(at_rest, 0, 3)), 0);
  const auto half_dark =
      speed_sigmas(at_rest, 30, 2, [](cv::Mat& grey, int) { grey.rowRange(0, 400).setTo(0); });
  EXPECT_EQ(frames_at_rest(half_dark), 0);
}

TEST(StandstillDetector, AcceptsAnyImage) {
  StandstillDetector detector;
  int i = 0;
  for (const cv::Size size : {cv::Size(8, 8), cv::Size(1, 1), cv::Size(64, 48), cv::Size(640, 480),
                              cv::Size(3840, 200), cv::Size(64, 48)}) {
    for (int repeat = 0; repeat < 3; ++repeat, ++i) {
      const cv::Mat grey(size, CV_8UC1, cv::Scalar(100));
      EXPECT_FALSE(detector.update({from_seconds(i), i, grey}));
    }
  }
}

}  // namespace
}  // namespace stillkite
