#include "navigation/frame_interval.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "tests/navigation/rendered_flight.hpp"

namespace stillkite {
namespace {

using test::rendered_flight;

// Image repeated by a video codec: small coding noise.
cv::Mat reencoded(const cv::Mat& image, cv::RNG& random) {
  cv::Mat change(image.size(), CV_8SC1);
  random.fill(change, cv::RNG::NORMAL, 0, 0.4);
  cv::Mat out;
  cv::add(image, change, out, {}, CV_8U);
  return out;
}

Frame frame_of(int i, const cv::Mat& grey) {
  return {from_seconds(0.04 * i), i, grey};
}

// Clock after the first `count` images of the flight.
FrameClock clock_after(int count) {
  FrameClock clock(1);
  for (int i = 0; i < count; ++i) {
    const cv::Mat& grey = rendered_flight().frames[static_cast<std::size_t>(i)].grey;
    EXPECT_NE(clock.check(frame_of(i, grey)).rejection, Verdict::frozen) << i;
  }
  return clock;
}

TEST(FrameClock, RejectsReencodedImageAfterMotion) {
  const cv::Mat& image = rendered_flight().frames[0].grey;
  cv::RNG random(1);
  FrameClock at_rest = clock_after(1);
  EXPECT_FALSE(at_rest.check(frame_of(1, reencoded(image, random))).rejection);
  EXPECT_FALSE(at_rest.check(frame_of(2, reencoded(image, random))).rejection);
  FrameClock moving = clock_after(5);
  const cv::Mat& last = rendered_flight().frames[4].grey;
  EXPECT_EQ(moving.check(frame_of(5, reencoded(last, random))).rejection, Verdict::frozen);
}

TEST(FrameClock, StaysFrozenUntilMotion) {
  const auto& frames = rendered_flight().frames;
  cv::RNG random(1);
  FrameClock clock = clock_after(5);
  for (int i = 5; i < 60; ++i) {
    EXPECT_EQ(clock.check(frame_of(i, reencoded(frames[4].grey, random))).rejection,
              Verdict::frozen);
  }
  EXPECT_FALSE(clock.check(frame_of(60, frames[5].grey)).rejection);
}

// A camera that stops at constant deceleration.
TEST(FrameClock, AcceptsASmoothStop) {
  const cv::Mat& image = rendered_flight().frames[0].grey;
  cv::RNG random(1);
  FrameClock clock(1);
  double displacement_px = 0;
  for (int i = 0; i < 12; ++i) {
    cv::Mat moved;
    const cv::Mat shift = (cv::Mat_<double>(2, 3) << 1, 0, displacement_px, 0, 1, 0);
    cv::warpAffine(image, moved, shift, image.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT);
    EXPECT_NE(clock.check(frame_of(i, reencoded(moved, random))).rejection, Verdict::frozen) << i;
    displacement_px += std::clamp(0.5 * (9 - i), 0.0, 3.0);
  }
}

TEST(FrameClock, AcceptsSlowMotionAfterAFlash) {
  cv::Mat image = rendered_flight().frames[0].grey;
  FrameClock clock(1);
  for (int i = 0; i < 30; ++i) {  // 0.3 px per frame
    cv::Mat moved;
    const cv::Mat shift = (cv::Mat_<double>(2, 3) << 1, 0, 0.3 * i, 0, 1, 0);
    cv::warpAffine(image, moved, shift, image.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT);
    if (i == 10 || i == 11) moved.colRange(0, moved.cols / 2).setTo(255);
    const auto rejection = clock.check(frame_of(i, moved)).rejection;
    EXPECT_EQ(rejection, i == 0 ? std::optional(Verdict::first_frame) : std::nullopt) << i;
  }
}

TEST(FrameClock, AcceptsSlowMotionWhileTheExposureChanges) {
  const cv::Mat& image = rendered_flight().frames[0].grey;
  FrameClock clock(1);
  for (int i = 0; i < 30; ++i) {  // 0.3 px per frame
    cv::Mat moved;
    const cv::Mat shift = (cv::Mat_<double>(2, 3) << 1, 0, 0.3 * i, 0, 1, 0);
    cv::warpAffine(image, moved, shift, image.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT);
    moved.convertTo(moved, CV_8U, i % 8 < 6 ? 0.6 : 0.9);
    const auto rejection = clock.check(frame_of(i, moved)).rejection;
    EXPECT_EQ(rejection, i == 0 ? std::optional(Verdict::first_frame) : std::nullopt) << i;
  }
}

// 8 images/s in a video of 25 frames/s.
TEST(FrameClock, TracksVideoWithTwoThirdsRepeatedImages) {
  SimulationConfig config = test::small_flight(1);
  config.flight.duration_s = 4;
  const test::RenderedFlight flight = test::render_flight(config);
  for (const Policy policy : {Policy::flow, Policy::best, Policy::fused}) {
    Navigator navigator(flight.record.camera, flight.record.body_from_camera, {}, flight.start(),
                        {.policy = policy});
    cv::RNG random(1);
    for (std::size_t i = 0; i < flight.frames.size(); ++i) {
      const std::size_t source = i / 3 * 3;
      Frame frame = flight.frames[i];
      frame.grey =
          i == source ? flight.frames[source].grey : reencoded(flight.frames[source].grey, random);
      const NavigationEstimate e = navigator.step(frame);
      if (i < 10) continue;
      EXPECT_EQ(e.verdict, i == source ? Verdict::ok : Verdict::frozen) << name_of(policy) << i;
      EXPECT_LT((e.world_from_body.translation - flight.truth(i).translation).norm(), 0.3)
          << name_of(policy) << i;
    }
  }
}

}  // namespace
}  // namespace stillkite
