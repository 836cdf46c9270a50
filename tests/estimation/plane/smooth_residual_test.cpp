#include "estimation/plane/smooth_residual.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace stillkite {
namespace {

constexpr int kPerCell = 30;
constexpr float kTexture = 1e4F;

// Tiles of isotropic texture, kPerCell of them in each cell.
struct CellTiles {
  TileJacobian jacobian;
  TileMeasurements measurements;
  std::vector<int> cluster;
  std::vector<float> weights;
  std::mt19937 random;

  explicit CellTiles(unsigned seed) : random(seed) {
    constexpr int kCount = kPerCell * PlaneObservations::kClusters;
    jacobian.count = kCount;
    jacobian.rows.assign(16 * kCount, 0);
    for (auto* v : {&measurements.gxx, &measurements.gyy}) v->assign(kCount, kTexture);
    for (auto* v : {&measurements.gxy, &measurements.gx, &measurements.gy}) v->assign(kCount, 0);
    for (int i = 0; i < kCount; ++i) cluster.push_back(i / kPerCell);
    weights.assign(kCount, 1);
  }

  void add(int cell, float x_px, float y_px) {
    for (int i = cell * kPerCell; i < (cell + 1) * kPerCell; ++i) {
      measurements.gx[static_cast<std::size_t>(i)] += kTexture * x_px;
      measurements.gy[static_cast<std::size_t>(i)] += kTexture * y_px;
    }
  }

  void add_noise(float sigma_px) {
    std::normal_distribution<float> normal(0, kTexture * sigma_px);
    for (auto* v : {&measurements.gx, &measurements.gy}) {
      for (float& x : *v) x += normal(random);
    }
  }

  [[nodiscard]] SmoothResidual measure(double noise_px) const {
    PlaneSolution solution;
    solution.noise_variance = noise_px * noise_px * static_cast<double>(kTexture);
    return measure_smooth_residual({jacobian, measurements, cluster, 128}, solution, weights)
        .value();
  }
};

TEST(SmoothResidual, IndependentNoiseIsNone) {
  double sum = 0;
  constexpr int kSeeds = 30;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    CellTiles tiles(seed);
    tiles.add_noise(0.2F);
    const SmoothResidual smooth = tiles.measure(0.2);
    EXPECT_LT(std::abs(smooth.variance_px2), 4 * smooth.sigma_px2) << seed;
    sum += smooth.variance_px2 / smooth.sigma_px2;
  }
  EXPECT_LT(std::abs(sum) / kSeeds, 4 / std::sqrt(kSeeds));
}

TEST(SmoothResidual, CommonDisplacementIsItsSquare) {
  CellTiles tiles(1);
  for (int cell = 0; cell < PlaneObservations::kClusters; ++cell) tiles.add(cell, 0.1F, -0.2F);
  EXPECT_NEAR(tiles.measure(0.01).variance_px2, 0.5 * (0.1 * 0.1 + 0.2 * 0.2), 1e-6);
}

TEST(SmoothResidual, DisplacementOfOneCellIsNone) {
  CellTiles tiles(1);
  tiles.add(20, 3, 3);
  EXPECT_NEAR(tiles.measure(0.01).variance_px2, 0, 1e-9);
}

// Tiles of weight w displace the motion w times as much.
TEST(SmoothResidual, RejectedTilesCountByTheirInfluence) {
  CellTiles tiles(1);
  for (int cell = 0; cell < PlaneObservations::kClusters; ++cell) tiles.add(cell, 1, 0);
  tiles.weights.assign(tiles.weights.size(), 0.1F);
  EXPECT_NEAR(tiles.measure(0.01).variance_px2, 0.5 * 0.1 * 0.1, 1e-6);
}

TEST(SmoothResidual, IsEmptyWithoutTexture) {
  CellTiles tiles(1);
  for (auto* v : {&tiles.measurements.gxx, &tiles.measurements.gyy}) v->assign(v->size(), 1);
  EXPECT_FALSE(measure_smooth_residual({tiles.jacobian, tiles.measurements, tiles.cluster, 128}, {},
                                       tiles.weights));
}

}  // namespace
}  // namespace stillkite
