#include "estimation/plane/plane_relief.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace stillkite {
namespace {

constexpr int kTiles = 2000;
constexpr float kParallax_px = 8;

/// Tiles of isotropic texture, displaced along x by the translation: relief and, in any direction,
/// noise.
struct Tiles {
  TileJacobian jacobian{.count = kTiles, .rows = std::vector<float>(16 * kTiles)};
  TileMeasurements measurements;
  std::vector<int> cluster = std::vector<int>(kTiles);

  /// `excess`: of the noise along the parallax, in variances of the noise.
  Tiles(double relief, double noise_px, int seed, double excess = 0) {
    constexpr float kGradient = 1e4F;
    std::mt19937 random(static_cast<std::mt19937::result_type>(seed));
    std::normal_distribution<float> normal;
    for (auto* v : {&measurements.gxx, &measurements.gyy}) v->assign(kTiles, kGradient);
    for (auto* v : {&measurements.gxy, &measurements.gx, &measurements.gy}) v->assign(kTiles, 0);
    for (std::size_t i = 0; i < kTiles; ++i) {
      jacobian.rows[i] = kParallax_px;  // x by the first translation
      const float error_x = static_cast<float>(relief) * kParallax_px * normal(random) +
                            static_cast<float>(noise_px * std::sqrt(1 + excess)) * normal(random);
      measurements.gx[i] = kGradient * error_x;
      measurements.gy[i] = kGradient * static_cast<float>(noise_px) * normal(random);
    }
  }

  /// `translation`: of the motion; 1 displaces the tiles by kParallax_px.
  [[nodiscard]] ReliefMeasurement measure(double translation = 1) const {
    return measure_relief({jacobian, measurements, cluster, 128}, {}, {translation, 0, 0}).value();
  }
};

TEST(PlaneRelief, IsMeasuredAlongTheEpipolarLines) {
  const ReliefMeasurement measurement = Tiles(0.05, 0.1, 1).measure();
  EXPECT_NEAR(measurement.variance, 0.05 * 0.05, 3e-4);
  EXPECT_TRUE(is_in_range(measurement, 0.05));
  EXPECT_FALSE(is_in_range(measurement, 0.2));
}

TEST(PlaneRelief, NoiseInAllDirectionsIsNone) {
  for (int seed = 1; seed <= 20; ++seed) {
    const ReliefMeasurement measurement = Tiles(0, 0.3, seed).measure();
    EXPECT_LT(std::abs(measurement.variance), 3 * measurement.sigma) << seed;
  }
}

TEST(PlaneRelief, IsUnknownWithoutParallax) {
  const Tiles tiles(0.05, 0.1, 1);
  EXPECT_FALSE(
      measure_relief({tiles.jacobian, tiles.measurements, tiles.cluster, 128}, {}, {0.001, 0, 0}));
}

TEST(ReliefFilter, RoomIsNotFlatAndGroundIs) {
  ReliefFilter room, ground;
  EXPECT_TRUE(room.is_flat());
  for (int frame = 1; frame <= 10; ++frame) {
    room.update(Tiles(0.2, 0.1, frame).measure());
    ground.update(Tiles(0.01, 0.02, frame).measure());
    EXPECT_FALSE(room.is_flat());
    EXPECT_TRUE(ground.is_flat());
  }
  EXPECT_NEAR(room.ratio(), 0.2, 0.02);
  EXPECT_NEAR(ground.ratio(), 0.01, 0.002);
}

TEST(ReliefFilter, UncertaintyIsIncludedAndFalls) {
  ReliefFilter filter;
  const double at_start = filter.ratio();
  for (int frame = 1; frame <= 30; ++frame) {
    filter.update(Tiles(0, 0.2, frame).measure());
    EXPECT_TRUE(filter.is_flat()) << frame;
  }
  EXPECT_LT(filter.ratio(), 0.3 * at_start);
}

// Coding errors follow the motion. At a constant parallax they look like relief of 7 % of the
// height; a larger parallax shows that they are none.
TEST(ReliefFilter, NoiseAlongTheMotionIsNoRelief) {
  ReliefFilter filter;
  for (int frame = 1; frame <= 40; ++frame) {
    filter.update(Tiles(0, 0.2, frame, 0.8).measure(0.3));
    EXPECT_TRUE(filter.is_flat()) << frame;
  }
  EXPECT_GT(filter.ratio(), 0.06);
  for (int frame = 41; frame <= 60; ++frame) {
    filter.update(Tiles(0, 0.2, frame, 0.8).measure(1.5));
    EXPECT_TRUE(filter.is_flat()) << frame;
  }
  EXPECT_LT(filter.ratio(), 0.04);
}

TEST(ReliefFilter, IsFiniteWithoutNoise) {
  ReliefFilter filter;
  for (int frame = 0; frame < 3; ++frame) filter.update(Tiles(0, 0, 1).measure());
  EXPECT_TRUE(filter.is_flat());
  EXPECT_LT(filter.ratio(), 0.001);
}

TEST(ReliefFilter, GroundAfterARoomIsFlatAgain) {
  ReliefFilter filter;
  for (int frame = 1; frame <= 30; ++frame) filter.update(Tiles(0.2, 0.1, frame).measure());
  filter.update(Tiles(0, 0.1, 31).measure());
  EXPECT_FALSE(filter.is_flat()) << "relief of a room is out of range at this parallax";
  for (int frame = 1; frame <= 3; ++frame) filter.update(Tiles(0, 0.05, frame).measure(0.5));
  EXPECT_TRUE(filter.is_flat());
}

}  // namespace
}  // namespace stillkite
