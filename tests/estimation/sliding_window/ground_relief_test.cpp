#include "estimation/sliding_window/ground_relief.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace stillkite {
namespace {

constexpr double kHeight_m = 10;

// Measured heights: `ground` of them with a relief, the others up to half the camera's height.
std::vector<PointHeight> heights(int ground, double relief_m, int others, double sigma_m) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0.1 * kHeight_m, 0.5 * kHeight_m);
  std::vector<PointHeight> out;
  for (int i = 0; i < ground + others; ++i) {
    const double true_m = i < ground ? relief_m * normal(random) : uniform(random);
    out.push_back({true_m + sigma_m * normal(random), sigma_m * sigma_m});
  }
  return out;
}

GroundRelief estimated(const std::vector<PointHeight>& points) {
  GroundRelief relief(kHeight_m);
  for (int i = 0; i < 30; ++i) {
    relief.begin_update();
    for (const PointHeight& point : points) relief.add(point);
    relief.update();
  }
  return relief;
}

TEST(WindowRelief, IsThatOfThePointsWithoutTheirNoise) {
  const GroundRelief relief = estimated(heights(400, 0.05, 0, 0.05));
  EXPECT_NEAR(relief.sigma_m(), 0.05, 0.01);
  EXPECT_GT(relief.share(), 0.95);
  EXPECT_TRUE(relief.is_plane());
}

TEST(WindowRelief, IsThatOfTheGroundAmongOtherPoints) {
  const GroundRelief relief = estimated(heights(450, 0.02, 50, 0.05));
  EXPECT_LT(relief.sigma_m(), 0.06);
  EXPECT_NEAR(relief.share(), 0.9, 0.03);
  EXPECT_GT(relief.probability({0, 0.05 * 0.05}), 0.9);
  EXPECT_LT(relief.probability({3, 0.05 * 0.05}), 1e-6);
}

TEST(WindowRelief, RecognizesARoughGround) {
  const GroundRelief relief = estimated(heights(200, 1, 0, 0.1));
  EXPECT_TRUE(relief.is_rough());
  EXPECT_FALSE(relief.is_plane());
}

TEST(WindowRelief, IsUnknownAsLongAsImagesShowNoHeights) {
  const GroundRelief before(kHeight_m);
  const GroundRelief relief = estimated(heights(20, 0, 0, 1000));
  EXPECT_NEAR(relief.sigma_m(), before.sigma_m(), 0.01 * before.sigma_m());
  EXPECT_NEAR(relief.share(), before.share(), 0.1);
  EXPECT_FALSE(relief.is_plane());
  EXPECT_FALSE(relief.is_rough());
}

TEST(WindowRelief, KeepsPointsThatLeave) {
  const std::vector<PointHeight> points = heights(100, 0.1, 0, 0.05);
  GroundRelief relief = estimated(points);
  const double before_m = relief.sigma_m();
  for (const PointHeight& point : points) relief.keep(point);
  relief.begin_update();
  relief.update();
  EXPECT_NEAR(relief.sigma_m(), before_m, 0.01 * before_m);
  EXPECT_GT(relief.share(), 0.95);
}

}  // namespace
}  // namespace stillkite
