#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/navigation/rendered_flight.hpp"

namespace stillkite {
namespace {

using test::is_finite;
using test::rendered_flight;

// Tiles on non-rigid ground have independent flow.
TEST(MovingGround, RejectsNonRigidFlow) {
  const cv::Mat still = rendered_flight().frames[0].grey;
  Navigator navigator = rendered_flight().navigator();
  cv::RNG random(3);
  for (int i = 0; i < 20; ++i) {
    cv::Mat x, y, displacements_px(still.rows / 40, still.cols / 40, CV_32FC2);
    random.fill(displacements_px, cv::RNG::NORMAL, 0, 1.0);
    cv::resize(displacements_px, displacements_px, still.size(), 0, 0, cv::INTER_CUBIC);
    for (int row = 0; row < displacements_px.rows; ++row) {
      for (int column = 0; column < displacements_px.cols; ++column) {
        displacements_px.at<cv::Vec2f>(row, column) +=
            cv::Vec2f(static_cast<float>(column), static_cast<float>(row));
      }
    }
    cv::Mat grey;
    cv::remap(still, grey, displacements_px, {}, cv::INTER_CUBIC, cv::BORDER_REFLECT);
    const NavigationEstimate e = navigator.step({from_seconds(0.04 * i), i, grey});
    ASSERT_TRUE(is_finite(e));
    if (i > 0) {
      EXPECT_EQ(e.verdict, Verdict::too_few_inliers) << i;
    }
  }
}

// Hills of 3 m at 30 m are rigid: the tiles' deviation is parallax of the camera's translation.
TEST(MovingGround, AcceptsRigidRelief) {
  SimulationConfig config = test::small_flight(1);
  config.flight.duration_s = 1;
  config.flight.height_m = 30;
  config.flight.forward_m = 8;
  config.flight.left_m = 0;
  config.flight.climb_m = 0;
  config.flight.sway_m = 0;
  config.ground.relief.amplitude_m = 3;
  config.ground.relief.correlation_length_m = 15;
  const test::RenderedFlight flight = test::render_flight(config);
  const auto estimates = test::fly(flight.navigator(), flight.frames);
  for (std::size_t i = 1; i < estimates.size(); ++i) EXPECT_EQ(estimates[i].verdict, Verdict::ok);
}

// Drone over surf, at full and half resolution. No ground truth; waves are not rigid.
TEST(MovingGround, RejectsSurf) {
  const char* data = std::getenv("STILLKITE_DATA");
  if (data == nullptr || *data == '\0') GTEST_SKIP() << "STILLKITE_DATA is not set";
  const std::filesystem::path folder = std::filesystem::path(data) / "surf";
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".jpg") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  const Camera full{1920, 1080, 1400, 1400, 959.5, 539.5};
  const RigidTransform mount = rendered_flight().record.body_from_camera;
  const InitialState start{{Eigen::Quaterniond::Identity(), {0, 0, 100}},
                           ScaleSource::initial_height};
  for (const bool halved : {false, true}) {
    Navigator navigator(halved ? half_resolution(full) : full, mount, {}, start);
    for (std::size_t i = 0; i < files.size(); ++i) {
      cv::Mat grey = cv::imread(files[i].string(), cv::IMREAD_GRAYSCALE);
      if (halved) cv::resize(grey, grey, {}, 0.5, 0.5, cv::INTER_AREA);
      const NavigationEstimate e = navigator.step(
          {from_seconds(0.1 * static_cast<double>(i)), static_cast<std::int64_t>(i), grey});
      ASSERT_TRUE(is_finite(e));
      EXPECT_NE(e.verdict, Verdict::ok) << i;
    }
  }
}

}  // namespace
}  // namespace stillkite
