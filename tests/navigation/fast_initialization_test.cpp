#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "navigation/keyframe_navigator.hpp"
#include "tests/navigation/rendered_flight.hpp"

namespace stillkite {
namespace {

struct FastFlight {
  int width_px, height_px;
  double flow_px;  // between frames, at the image centre
  double tilt_deg = 0;
  const char* photograph = nullptr;
};

void PrintTo(const FastFlight& flight, std::ostream* out) {
  *out << flight.width_px << "x" << flight.height_px << ", " << flight.flow_px << " px/frame, tilt "
       << flight.tilt_deg << " deg, " << (flight.photograph ? flight.photograph : "own ground");
}

SimulationConfig config_of(const FastFlight& flight) {
  constexpr double kHeight_m = 50;
  SimulationConfig config;
  config.camera.width_px = flight.width_px;
  config.camera.height_px = flight.height_px;
  config.camera.focal_x_px = config.camera.focal_y_px = 0.65 * flight.width_px;
  config.camera.centre_x_px = 0.5 * (flight.width_px - 1);
  config.camera.centre_y_px = 0.5 * (flight.height_px - 1);
  config.camera.forward_tilt_deg = flight.tilt_deg;
  config.flight.duration_s = 0.2;
  config.flight.height_m = kHeight_m;
  const double distance_m = kHeight_m / std::cos(flight.tilt_deg * M_PI / 180);
  const double displacement_m = 5 * flight.flow_px * distance_m / config.camera.focal_x_px;
  config.flight.forward_m = 0.8 * displacement_m;
  config.flight.left_m = 0.6 * displacement_m;
  config.flight.climb_m = 0;
  config.flight.sway_m = 0;
  config.ground.side_texels = 1500;
  return config;
}

class FastInitialization : public testing::TestWithParam<FastFlight> {};

TEST_P(FastInitialization, EstimatesVelocityFromSecondFrame) {
  SimulationConfig config = config_of(GetParam());
  cv::Mat photograph;
  if (GetParam().photograph != nullptr) {
    const char* data = std::getenv("STILLKITE_DATA");
    if (data == nullptr || *data == '\0') GTEST_SKIP() << "STILLKITE_DATA is not set";
    config.ground.photograph =
        std::filesystem::path(data) / "ground_photos" / GetParam().photograph;
    photograph = cv::imread(config.ground.photograph->string(), cv::IMREAD_GRAYSCALE);
    ASSERT_FALSE(photograph.empty());
  }
  const test::RenderedFlight flight = test::render_flight(config, photograph);
  const auto estimates = test::fly(flight.navigator(), flight.frames);
  for (std::size_t i = 1; i < estimates.size(); ++i) {
    ASSERT_EQ(estimates[i].verdict, Verdict::ok) << i;
    const Twist& truth = flight.record.twists_in_camera[i - 1].twist;
    EXPECT_LT((estimates[i].twist_in_camera.velocity_m_s - truth.velocity_m_s).norm(),
              0.03 * truth.velocity_m_s.norm())
        << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Navigator, FastInitialization,
                         testing::Values(FastFlight{320, 240, 20}, FastFlight{320, 240, 70},
                                         FastFlight{320, 240, 40, 30}, FastFlight{640, 480, 70},
                                         FastFlight{640, 480, 100, 30}, FastFlight{1280, 720, 80},
                                         FastFlight{320, 240, 40, 0, "forest.jpg"},
                                         FastFlight{640, 480, 100, 30, "shore_a.jpg"},
                                         FastFlight{640, 480, 70, 0, "field_weak_texture.jpg"}));

// A search takes several times as long as an alignment, so a filter can disable it.
TEST(KeyframeNavigator, SearchesAImageOnlyWhereItMay) {
  const test::RenderedFlight flight = test::render_flight(config_of({320, 240, 70}));
  for (const bool allow_search : {true, false}) {
    KeyframeNavigator navigator(flight.record.camera, flight.record.body_from_camera, {},
                                flight.start());
    FrameClock clock(1);
    (void)navigator.step(flight.frames[0], clock.check(flight.frames[0]), {},
                         {.allow_search = allow_search});
    const NavigationEstimate second = navigator.step(
        flight.frames[1], clock.check(flight.frames[1]), {}, {.allow_search = allow_search});
    EXPECT_EQ(second.verdict == Verdict::ok, allow_search) << name_of(second.verdict);
  }
}

// Half a second of the flight is missing: 3 m at 40 m height, covered by the prediction.
TEST(Gap, IsBridgedByPredictionAndNextFrameAligns) {
  const auto& flight = test::rendered_flight();
  Navigator navigator = flight.navigator();
  for (std::size_t i = 0; i < flight.frames.size(); ++i) {
    if (i >= 15 && i < 28) continue;
    const NavigationEstimate e = navigator.step(flight.frames[i]);
    if (i == 0) continue;
    EXPECT_EQ(e.verdict, Verdict::ok) << i;
    EXPECT_LT((e.world_from_body.translation - flight.truth(i).translation).norm(), 0.05) << i;
  }
}

// Scene cut between two frames: the old keyframe does not match, the first pair of the new scene
// does.
TEST(Cut, IsRejectedThenNewSceneIsTracked) {
  const auto& flight = test::rendered_flight();
  Navigator navigator = flight.navigator();
  for (std::size_t i = 0; i < flight.frames.size(); ++i) {
    Frame frame = flight.frames[i];
    if (i >= 20) {
      cv::Mat elsewhere;
      cv::rotate(frame.grey, elsewhere, cv::ROTATE_180);
      frame.grey = elsewhere;
    }
    const NavigationEstimate e = navigator.step(frame);
    if (i >= 20 && i < 24) {
      EXPECT_EQ(e.verdict, Verdict::lost) << i;
    } else if (i >= 28) {
      EXPECT_EQ(e.verdict, Verdict::ok) << i;
      // the image is rotated by 180 degrees: the velocity is reversed
      const Twist& truth = flight.record.twists_in_camera[i - 1].twist;
      EXPECT_LT((e.twist_in_camera.velocity_m_s.head<2>() + truth.velocity_m_s.head<2>()).norm(),
                0.05 * truth.velocity_m_s.norm())
          << i;
    }
  }
}

}  // namespace
}  // namespace stillkite
