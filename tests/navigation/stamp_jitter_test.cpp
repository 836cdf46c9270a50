#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "navigation/keyframe_navigator.hpp"
#include "tests/navigation/rendered_flight.hpp"

// Covariances of velocities and rates with time stamps of known jitter.

namespace stillkite {
namespace {

constexpr double kJitter_s = 2e-3;  // 7 % of an interval of 40 ms
constexpr std::size_t kFirst = 2;

std::vector<Frame> jittered(std::vector<Frame> frames, double stated_sigma_s) {
  std::mt19937 random(11);
  std::normal_distribution<> error_s(0, kJitter_s);
  for (Frame& frame : frames) {
    frame.stamp.ns += std::llround(1e9 * error_s(random));
    frame.stamp_sigma_s = stated_sigma_s;
  }
  return frames;
}

// Share of frames whose speed differs from that of exact stamps by more than three sigma.
double share_beyond_3_sigma(Mode mode, double stated_sigma_s) {
  const test::RenderedFlight& flight = test::rendered_flight();
  NavigatorConfig config{.lens_sigma_px = 0};
  config.paper.filter.variance = MeasurementVariance::measured;
  const auto exact = test::fly(flight.navigator(config, mode), flight.frames);
  const auto answers =
      test::fly(flight.navigator(config, mode), jittered(flight.frames, stated_sigma_s));
  int beyond = 0;
  for (std::size_t k = kFirst; k < answers.size(); ++k) {
    const Eigen::Vector3d velocity = exact[k].twist_in_camera.velocity_m_s;
    const Eigen::Vector3d along = velocity.normalized();
    const double error_m_s = along.dot(answers[k].twist_in_camera.velocity_m_s - velocity);
    const double variance = along.dot(answers[k].twist_covariance.topLeftCorner<3, 3>() * along);
    beyond += error_m_s * error_m_s > 9 * variance;
  }
  return static_cast<double>(beyond) / static_cast<double>(answers.size() - kFirst);
}

TEST(StampJitter, IsInTheVelocityCovarianceOfTheFlow) {
  EXPECT_LT(share_beyond_3_sigma(Mode::recommended, kJitter_s), 0.05);
  // the innovations show a part of it
  EXPECT_GT(share_beyond_3_sigma(Mode::recommended, 0), 0.1);
}

TEST(StampJitter, IsInTheVelocityCovarianceOfThePaperMode) {
  EXPECT_LT(share_beyond_3_sigma(Mode::paper, kJitter_s), 0.05);
  EXPECT_GT(share_beyond_3_sigma(Mode::paper, 0), 0.3);
}

// Displacements within the jitter do not reset the velocity.
TEST(StampJitter, IsNoJump) {
  const test::RenderedFlight& flight = test::rendered_flight();
  std::vector<Frame> frames = jittered(flight.frames, kJitter_s);
  for (Frame& frame : frames) frame.stamp.ns /= 10;  // the same images at ten times the speed
  for (Frame& frame : frames) frame.stamp_sigma_s /= 10;
  for (const NavigationEstimate& estimate : test::fly(flight.navigator(), frames)) {
    if (estimate.frame_index < static_cast<std::int64_t>(kFirst)) continue;
    EXPECT_GT(estimate.twist_in_camera.velocity_m_s.norm(), 30)
        << estimate.frame_index;  // true: 60 m/s
  }
}

// Ten lost images without a gap in the stamps, 2.4 m: 30 sigma of a stamp error of 10 ms at 8
// m/s, but 4 sigma at the velocity of the jump itself.
TEST(StampJitter, DoesNotHideAJump) {
  const test::RenderedFlight& flight = test::rendered_flight();
  constexpr std::size_t kFirstShifted = 30, kLostFrames = 10;
  KeyframeNavigator navigator(flight.record.camera, flight.record.body_from_camera, {},
                              flight.start());
  FrameClock clock(NavigatorConfig{}.trust.max_gap_s);
  for (std::size_t i = 0; i <= kFirstShifted; ++i) {
    Frame frame = flight.frames[i];
    if (i == kFirstShifted) frame.grey = flight.frames[i + kLostFrames].grey;
    frame.stamp_sigma_s = 0.01;
    (void)navigator.step(frame, clock.check(frame), {});
    EXPECT_EQ(navigator.has_jumped(), i == kFirstShifted) << i;
  }
}

TEST(StampJitter, IsInTheRateCovarianceOfTheReference) {
  const test::RenderedFlight& flight = test::rendered_flight();
  const auto rate_variance = [&](double sigma_s) {
    std::vector<Frame> frames = flight.frames;
    for (Frame& frame : frames) frame.stamp_sigma_s = sigma_s;
    Navigator navigator(flight.record.camera, flight.record.body_from_camera, {}, flight.start(),
                        {.policy = Policy::reference});
    const NavigationEstimate last = test::fly(std::move(navigator), frames).back();
    const Eigen::Vector3d rate = last.twist_in_camera.angular_rate_rad_s;
    return std::pair(rate.squaredNorm(), last.twist_covariance.bottomRightCorner<3, 3>().trace());
  };
  const auto [square, exact] = rate_variance(0);
  const double ratio = std::sqrt(2.0) * kJitter_s / 0.04;  // relative error of the interval
  EXPECT_NEAR(rate_variance(kJitter_s).second - exact, square * ratio * ratio, 1e-9);
}

}  // namespace
}  // namespace stillkite
