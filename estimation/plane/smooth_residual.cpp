#include "estimation/plane/smooth_residual.hpp"

#include <Eigen/Core>
#include <array>
#include <cmath>

namespace stillkite {
namespace {

constexpr int kAcross = PlaneObservations::kClustersAcross;
constexpr int kDown = PlaneObservations::kClusters / kAcross;

// Structure tensor and right-hand side of the residuals of a cell.
struct CellSums {
  double gxx = 0, gxy = 0, gyy = 0, x = 0, y = 0;
};

// Mean residual of a cell, as far as it has influence on the motion: a moving object has little.
struct CellResidual {
  Eigen::Vector2d mean_px;
  double variance_px2;  // of a component, by independent noise
};

std::optional<CellResidual> residual_of(const CellSums& cell, double noise_variance) {
  constexpr double kMaxCondition = 100;  // of the structure tensor
  const double determinant = cell.gxx * cell.gyy - cell.gxy * cell.gxy;
  const double trace = cell.gxx + cell.gyy;
  if (!(determinant * kMaxCondition > trace * trace)) return std::nullopt;
  return CellResidual{{(cell.gyy * cell.x - cell.gxy * cell.y) / determinant,
                       (cell.gxx * cell.y - cell.gxy * cell.x) / determinant},
                      0.5 * noise_variance * trace / determinant};
}

}  // namespace

std::optional<SmoothResidual> measure_smooth_residual(const PlaneObservations& tiles,
                                                      const PlaneSolution& solution,
                                                      const std::vector<float>& weights) {
  constexpr int kMinPairs = 12;
  const TileMeasurements& m = tiles.measurements;
  const TileJacobian& J = tiles.jacobian;
  const Eigen::Matrix<float, 8, 1> step = step_without_prior(solution).cast<float>();
  std::array<CellSums, PlaneObservations::kClusters> sums;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (!(tiles.trace(i) > tiles.min_trace())) continue;
    float ux = 0, uy = 0;
    for (int a = 0; a < 8; ++a) {
      ux += J.x(a)[i] * step[a];
      uy += J.y(a)[i] * step[a];
    }
    const float w = weights[i];
    CellSums& cell = sums[static_cast<std::size_t>(tiles.cluster[i])];
    cell.gxx += static_cast<double>(m.gxx[i]);
    cell.gxy += static_cast<double>(m.gxy[i]);
    cell.gyy += static_cast<double>(m.gyy[i]);
    cell.x += static_cast<double>(w * (m.gx[i] - m.gxx[i] * ux - m.gxy[i] * uy));
    cell.y += static_cast<double>(w * (m.gy[i] - m.gxy[i] * ux - m.gyy[i] * uy));
  }
  std::array<std::optional<CellResidual>, PlaneObservations::kClusters> cells;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    cells[c] = residual_of(sums[c], solution.noise_variance);
  }
  // weights by noise: cells of little texture count less
  double products = 0, weight = 0;
  int pairs = 0;
  const auto add = [&](const auto& a, const auto& b) {
    if (!a || !b) return;
    const double w = 1 / std::sqrt(a->variance_px2 * b->variance_px2);
    products += 0.5 * w * a->mean_px.dot(b->mean_px);
    weight += w;
    ++pairs;
  };
  for (int row = 0; row < kDown; ++row) {
    for (int column = 0; column < kAcross; ++column) {
      const auto& cell = cells[static_cast<std::size_t>(row * kAcross + column)];
      if (column > 0) add(cell, cells[static_cast<std::size_t>(row * kAcross + column - 1)]);
      if (row > 0) add(cell, cells[static_cast<std::size_t>((row - 1) * kAcross + column)]);
    }
  }
  if (pairs < kMinPairs) return std::nullopt;
  return SmoothResidual{products / weight, std::sqrt(0.5 * pairs) / weight};
}

}  // namespace stillkite
