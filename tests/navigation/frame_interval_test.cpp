#include "navigation/frame_interval.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "tests/navigation/rendered_flight.hpp"

namespace stillkite {
namespace {

using test::rendered_flight;

constexpr double kFast_px_s = 100;  // 4 px per frame

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

TEST(FrameClock, RejectsReencodedImageIfMotionIsExpected) {
  const cv::Mat image = rendered_flight().frames[0].grey;
  cv::RNG random(1);
  FrameClock clock(1);
  (void)clock.check(frame_of(0, image));
  EXPECT_FALSE(clock.check(frame_of(1, reencoded(image, random))).rejection) << "no expected speed";
  EXPECT_FALSE(clock.check(frame_of(2, reencoded(image, random)), 20).rejection) << "0.8 px";
  EXPECT_EQ(clock.check(frame_of(3, reencoded(image, random)), kFast_px_s).rejection,
            Verdict::frozen);
}

TEST(FrameClock, StaysFrozenUntilMotion) {
  const auto& frames = rendered_flight().frames;
  cv::RNG random(1);
  FrameClock clock(1);
  (void)clock.check(frame_of(0, frames[0].grey));
  for (int i = 1; i < 50; ++i) {
    const double speed_px_s = i < 25 ? kFast_px_s : 0;  // not measured any more
    EXPECT_EQ(clock.check(frame_of(i, reencoded(frames[0].grey, random)), speed_px_s).rejection,
              Verdict::frozen);
  }
  EXPECT_FALSE(clock.check(frame_of(50, frames[1].grey)).rejection);
  EXPECT_FALSE(clock.check(frame_of(51, reencoded(frames[1].grey, random))).rejection);
}

TEST(FrameClock, AcceptsMovingImagesAtAnyExpectedSpeed) {
  const auto& frames = rendered_flight().frames;
  FrameClock clock(1);
  (void)clock.check(frames[0]);
  for (std::size_t i = 1; i < frames.size(); ++i) {
    for (const double speed_px_s : {kFast_px_s, 1e6}) {
      FrameClock same = clock;
      EXPECT_FALSE(same.check(frames[i], speed_px_s).rejection) << i;
    }
    (void)clock.check(frames[i]);
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
