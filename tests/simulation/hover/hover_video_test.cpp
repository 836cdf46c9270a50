#include "simulation/hover/hover_video.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>
#include <vector>

#include "simulation/camera_mount.hpp"
#include "tests/simulation/hover/small_hover_camera.hpp"

namespace stillkite {
namespace {

// Low-resolution camera at 10 Hz.
HoverConfig small_video() {
  HoverConfig config;
  config.plant.camera = small_hover_camera(200, 10);
  return config;
}

// Images delivered within 1.25 s under a fault; the drone moves forward at 1 m/s, 3 m over the
// floor.
std::vector<SentImage> sent_with(const FaultEffect& fault, bool is_stabilized = true,
                                 const HoverConfig& config = small_video()) {
  static const HoverWorld room = make_hover_world(config);
  HoverVideo video(config, room, {.stabilized = is_stabilized});
  std::vector<SentImage> sent;
  for (int step = 0; step <= 125; ++step) {
    const Timestamp now = from_seconds(0.01 * step);
    DroneTruth truth;
    truth.world_from_body.translation = {0.01 * step, 0, 3};
    truth.world_from_camera = truth.world_from_body * camera_raised_forward(75);
    const bool is_exposed = video.expose(truth, Eigen::Quaterniond::Identity(), now, fault);
    EXPECT_EQ(is_exposed, step % 10 == 0) << step;
    if (const auto ready = video.receive(now)) sent.push_back(*ready);
  }
  return sent;
}

bool is_same_image(const cv::Mat& a, const cv::Mat& b) {
  return cv::countNonZero(a != b) == 0;
}

TEST(HoverVideo, DeliversImagesAfterLatency) {
  const std::vector<SentImage> sent = sent_with({});
  ASSERT_EQ(sent.size(), 12U);
  for (std::size_t i = 0; i < sent.size(); ++i) {
    EXPECT_EQ(sent[i].frame.stamp, from_seconds(0.1 * static_cast<double>(i)));
    EXPECT_EQ(sent[i].due.ns - sent[i].frame.stamp.ns, from_seconds(0.11).ns);
    EXPECT_NEAR(sent[i].truth.world_from_body.translation.x(), to_seconds(sent[i].frame.stamp),
                1e-12);
  }
  EXPECT_FALSE(is_same_image(sent[0].frame.grey, sent[1].frame.grey));
  EXPECT_TRUE(sent_with({}, false).empty());
}

TEST(HoverVideo, FrozenVideoRepeatsImageWithNewStamps) {
  const std::vector<SentImage> sent = sent_with({.is_video_frozen = true});
  ASSERT_EQ(sent.size(), 12U);
  EXPECT_TRUE(is_same_image(sent[11].frame.grey, sent[0].frame.grey));
  EXPECT_NE(sent[11].frame.grey.data, sent[0].frame.grey.data);
  EXPECT_EQ(sent[11].frame.stamp, from_seconds(1.1));
}

TEST(HoverVideo, LosesEveryThirdFrame) {
  const std::vector<SentImage> sent = sent_with({.is_every_third_frame_lost = true});
  ASSERT_EQ(sent.size(), 8U);
  EXPECT_EQ(sent[1].frame.index, 1);
  EXPECT_EQ(sent[2].frame.index, 3);
}

TEST(HoverVideo, StampOffsetDoesNotAffectGroundTruth) {
  const std::vector<SentImage> sent = sent_with({.stamp_offset_s = 0.05});
  EXPECT_EQ(sent[1].frame.stamp, from_seconds(0.15));
  EXPECT_NEAR(sent[1].truth.world_from_body.translation.x(), 0.1, 1e-12);
}

TEST(HoverVideo, DarkImageIsNoise) {
  const cv::Mat dark = sent_with({.light_ratio = 0.005})[0].frame.grey;
  EXPECT_LT(cv::mean(dark)[0], 4);
}

// Row of the horizon for a camera 15 degrees below the horizontal: 59.5 - 120 tan(15 deg) = 27.
TEST(HoverVideo, FloorStepChangesImageBelowHorizonOnly) {
  const cv::Mat before = sent_with({})[0].frame.grey;
  const cv::Mat after = sent_with({.floor_displacement_m = {0, 0, 0.3}})[0].frame.grey;
  EXPECT_TRUE(is_same_image(before.rowRange(0, 20), after.rowRange(0, 20)));
  EXPECT_FALSE(is_same_image(before.rowRange(80, 120), after.rowRange(80, 120)));
}

double deviation_of(const cv::Mat& image) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(image, mean, deviation);
  return deviation[0];
}

// Contrast ratio 0.1 about grey 128; unchanged noise.
TEST(HoverVideo, HazeReducesContrastButNotNoise) {
  HoverConfig config = small_video();
  config.plant.camera.noise_grey = 0;
  const cv::Mat clear = sent_with({}, true, config)[0].frame.grey;
  config.plant.contrast_ratio = 0.1;
  const cv::Mat hazy = sent_with({}, true, config)[0].frame.grey;
  EXPECT_NEAR(cv::mean(hazy)[0], 128 + 0.1 * (cv::mean(clear)[0] - 128), 0.1);
  EXPECT_NEAR(deviation_of(hazy), 0.1 * deviation_of(clear), 0.15);
  config.plant.contrast_ratio = 0;
  config.plant.camera.noise_grey = 3;
  const cv::Mat fog = sent_with({}, true, config)[0].frame.grey;
  EXPECT_NEAR(cv::mean(fog)[0], 128, 0.1);
  EXPECT_NEAR(deviation_of(fog), 3, 0.1);
}

// At zero contrast the grey value is 128 x gain: ramp of 30 % over the 43 s of a trial, flicker of
// at most 5 %.
TEST(HoverVideo, AppliesGainRampAndFlicker) {
  HoverConfig config = small_video();
  config.plant.contrast_ratio = 0;
  config.plant.camera.gain_ramp_ratio = 0.3;
  const std::vector<SentImage> rising = sent_with({}, true, config);
  EXPECT_NEAR(cv::mean(rising[0].frame.grey)[0], 128, 0.1);
  EXPECT_NEAR(cv::mean(rising[10].frame.grey)[0], 128 * (1 + 0.3 * 1.0 / 43), 0.1);
  config.plant.camera.gain_ramp_ratio = 0;
  config.plant.camera.flicker_ratio = 0.05;
  double min_grey = 255, max_grey = 0;
  for (const SentImage& image : sent_with({}, true, config)) {
    min_grey = std::min(min_grey, cv::mean(image.frame.grey)[0]);
    max_grey = std::max(max_grey, cv::mean(image.frame.grey)[0]);
  }
  EXPECT_GT(max_grey - min_grey, 0.05 * 128);
  EXPECT_GT(min_grey, 128 * 0.95 - 0.1);
  EXPECT_LT(max_grey, 128 * 1.05 + 0.1);
}

// Objects at 2.7 m are initially in the field of view, below row 40.
TEST(HoverVideo, RendersMovingObjects) {
  HoverConfig config = small_video();
  config.plant.camera.noise_grey = 0;
  const cv::Mat empty = sent_with({}, true, config)[0].frame.grey;
  config.plant.moving_objects = MovingObjectConfig{.reach_m = 0.5};
  const std::vector<SentImage> sent = sent_with({}, true, config);
  EXPECT_FALSE(is_same_image(empty, sent[0].frame.grey));
  EXPECT_TRUE(is_same_image(empty.rowRange(0, 40), sent[0].frame.grey.rowRange(0, 40)));
  EXPECT_FALSE(is_same_image(sent[0].frame.grey, sent_with({}, true, config)[1].frame.grey));
}

}  // namespace
}  // namespace stillkite
