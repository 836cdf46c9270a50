#include <gtest/gtest.h>

#include <memory>
#include <opencv2/core.hpp>

#include "simulation/camera_mount.hpp"
#include "simulation/render/renderer.hpp"
#include "simulation/scene/procedural_ground.hpp"

namespace stillkite {
namespace {

constexpr int kPeriod = 40;

TEST(RepetitiveGround, RepeatsWithPeriodOnly) {
  const cv::Mat ground = repetitive_ground(procedural_ground(21, 21, 4), kPeriod, 500);
  ASSERT_EQ(ground.cols, 24 * kPeriod / 2 + 1);
  const cv::Rect here(0, 0, ground.cols - kPeriod, ground.rows - kPeriod);
  for (int shift = 1; shift <= kPeriod; ++shift) {
    const cv::Rect there(shift, 0, here.width, here.height);
    const double difference = cv::norm(ground(here), ground(there), cv::NORM_L1) / here.area();
    EXPECT_TRUE(shift == kPeriod ? difference == 0 : difference > 1) << shift;
  }
  const cv::Rect below(0, kPeriod, here.width, here.height);
  EXPECT_EQ(cv::norm(ground(here), ground(below), cv::NORM_INF), 0);
}

// Views from positions whole periods apart, beyond the border of the texture too.
TEST(RepetitiveGround, ViewsOnePeriodApartAreEqual) {
  constexpr double kTexel_m = 0.05;
  constexpr double kPeriod_m = kPeriod * kTexel_m;
  const Scene scene{.ground = std::make_shared<GroundTexture>(
                        repetitive_ground(procedural_ground(21, 21, 4), kPeriod, 300), kTexel_m)};
  const Camera camera{.width_px = 160,
                      .height_px = 120,
                      .focal_x_px = 150,
                      .focal_y_px = 150,
                      .centre_x_px = 79.5,
                      .centre_y_px = 59.5};
  const Renderer renderer(camera, 2);
  const auto view = [&](double x_m, double y_m) {
    return renderer.render(scene, {camera_looking_down(), {x_m, y_m, 6}});
  };
  const cv::Mat here = view(0.3, -0.2);
  for (const int periods : {1, 3, -8}) {
    EXPECT_LT(cv::norm(here, view(0.3 + periods * kPeriod_m, -0.2), cv::NORM_INF), 0.1);
    EXPECT_LT(cv::norm(here, view(0.3, -0.2 + periods * kPeriod_m), cv::NORM_INF), 0.1);
  }
  EXPECT_GT(cv::norm(here, view(0.3 + 0.5 * kPeriod_m, -0.2), cv::NORM_INF), 5);
}

}  // namespace
}  // namespace stillkite
