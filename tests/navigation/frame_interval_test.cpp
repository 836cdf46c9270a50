#include "navigation/frame_interval.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "tests/navigation/rendered_flight.hpp"

namespace stillkite {
namespace {

using test::rendered_flight;

constexpr double kFast_px_s = 100;  // 4 px a frame

// As a video codec leaves an image that it is sent again.
cv::Mat coded_again(const cv::Mat& image, cv::RNG& random) {
  cv::Mat change(image.size(), CV_8SC1);
  random.fill(change, cv::RNG::NORMAL, 0, 0.4);
  cv::Mat out;
  cv::add(image, change, out, {}, CV_8U);
  return out;
}

Frame frame_of(int i, const cv::Mat& grey) {
  return {from_seconds(0.04 * i), i, grey};
}

TEST(FrameClock, ImageCodedAgainIsFrozenWhereItMustHaveMoved) {
  const cv::Mat image = rendered_flight().frames[0].grey;
  cv::RNG random(1);
  FrameClock clock(1);
  (void)clock.pass(frame_of(0, image));
  EXPECT_FALSE(clock.pass(frame_of(1, coded_again(image, random))).spoiled) << "no speed known";
  EXPECT_FALSE(clock.pass(frame_of(2, coded_again(image, random)), 20).spoiled) << "0.8 px";
  EXPECT_EQ(clock.pass(frame_of(3, coded_again(image, random)), kFast_px_s).spoiled,
            Verdict::frozen);
}

TEST(FrameClock, ItStaysFrozenUntilItMoves) {
  const auto& frames = rendered_flight().frames;
  cv::RNG random(1);
  FrameClock clock(1);
  (void)clock.pass(frame_of(0, frames[0].grey));
  for (int i = 1; i < 50; ++i) {
    const double speed_px_s = i < 25 ? kFast_px_s : 0;  // forgotten meanwhile
    EXPECT_EQ(clock.pass(frame_of(i, coded_again(frames[0].grey, random)), speed_px_s).spoiled,
              Verdict::frozen);
  }
  EXPECT_FALSE(clock.pass(frame_of(50, frames[1].grey)).spoiled);
  EXPECT_FALSE(clock.pass(frame_of(51, coded_again(frames[1].grey, random))).spoiled);
}

TEST(FrameClock, ImagesThatMoveAreNotFrozenHoweverFastTheyShould) {
  const auto& frames = rendered_flight().frames;
  FrameClock clock(1);
  (void)clock.pass(frames[0]);
  for (std::size_t i = 1; i < frames.size(); ++i) {
    for (const double speed_px_s : {kFast_px_s, 1e6}) {
      FrameClock same = clock;
      EXPECT_FALSE(same.pass(frames[i], speed_px_s).spoiled) << i;
    }
    (void)clock.pass(frames[i]);
  }
}

// A camera of eight images a second in a video of 25.
TEST(FrameClock, FilmOfAThirdOfItsImagesIsFlown) {
  SimulationConfig config = test::small_flight(1);
  config.flight.duration_s = 4;
  const test::RenderedFlight flight = test::film(config);
  for (const Policy policy : {Policy::flow, Policy::best, Policy::fused}) {
    Navigator navigator(flight.record.camera, flight.record.body_from_camera, {}, flight.start(),
                        {.policy = policy});
    cv::RNG random(1);
    for (std::size_t i = 0; i < flight.frames.size(); ++i) {
      const std::size_t sent = i / 3 * 3;
      Frame frame = flight.frames[i];
      frame.grey =
          i == sent ? flight.frames[sent].grey : coded_again(flight.frames[sent].grey, random);
      const NavigationEstimate e = navigator.step(frame);
      if (i < 10) continue;
      EXPECT_EQ(e.verdict, i == sent ? Verdict::ok : Verdict::frozen) << name_of(policy) << i;
      EXPECT_LT((e.world_from_body.translation - flight.truth(i).translation).norm(), 0.3)
          << name_of(policy) << i;
    }
  }
}

}  // namespace
}  // namespace stillkite
