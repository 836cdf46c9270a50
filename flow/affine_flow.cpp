#include "flow/affine_flow.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "geometry/median.hpp"

namespace stillkite {
namespace {

using Vector6f = Eigen::Matrix<float, 6, 1>;

constexpr int kMinDisplacements = 8;
constexpr float kSigmaOfMedian = 1.4826F;

Eigen::Vector2f mean_of(const std::vector<Eigen::Vector2f>& values,
                        const std::vector<unsigned char>& used, int count) {
  Eigen::Vector2f sum = Eigen::Vector2f::Zero();
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (used[i] != 0) sum += values[i];
  }
  return sum / static_cast<float>(std::max(1, count));
}

// Tukey biweight of a residual r at scale s: (1 - (r / 4.685 s)^2)^2.
float tukey_weight(float residual_px, float sigma) {
  const float u = residual_px / (4.685F * sigma);
  return u < 1 ? (1 - u * u) * (1 - u * u) : 0;
}

// Both rows of the affine model share one 3x3 normal matrix.
void fit_weighted(const std::vector<Eigen::Vector2f>& points_px,
                  const std::vector<Eigen::Vector2f>& displacements_px,
                  const std::vector<float>& weights, AffineFlow& flow) {
  Eigen::Matrix3f normal = Eigen::Matrix3f::Zero();
  Eigen::Matrix<float, 3, 2> right = Eigen::Matrix<float, 3, 2>::Zero();
  for (std::size_t i = 0; i < points_px.size(); ++i) {
    if (weights[i] == 0) continue;
    const Eigen::Vector2f x = points_px[i] - flow.origin_px;
    const Eigen::Vector3f row(1, x.x(), x.y());
    normal += weights[i] * row * row.transpose();
    right += weights[i] * row * displacements_px[i].transpose();
  }
  const Eigen::Matrix<float, 3, 2> fit = normal.ldlt().solve(right);
  if (!fit.allFinite()) return;
  flow.offset_px = fit.row(0).transpose();
  flow.gradient = fit.bottomRows<2>().transpose();
}

}  // namespace

AffineFlow fit_affine_flow(const std::vector<Eigen::Vector2f>& points_px,
                           const std::vector<Eigen::Vector2f>& displacements_px,
                           const std::vector<unsigned char>& used) {
  constexpr int kIterations = 4;
  constexpr float kMinSigma_px = 0.05F;
  AffineFlow flow;
  const int count = static_cast<int>(std::count(used.begin(), used.end(), 1));
  flow.origin_px = mean_of(points_px, used, count);
  flow.offset_px = mean_of(displacements_px, used, count);
  flow.inliers = count;
  if (count < kMinDisplacements) return flow;

  // initial value: the median, robust to a third of outliers
  std::vector<float> x, y, residuals_px;
  for (std::size_t i = 0; i < points_px.size(); ++i) {
    if (used[i] == 0) continue;
    x.push_back(displacements_px[i].x());
    y.push_back(displacements_px[i].y());
  }
  flow.offset_px = {upper_median(x), upper_median(y)};
  std::vector<float> weights(points_px.size());
  for (int iteration = 0; iteration <= kIterations; ++iteration) {
    residuals_px.clear();
    for (std::size_t i = 0; i < points_px.size(); ++i) {
      if (used[i] != 0) {
        residuals_px.push_back((displacements_px[i] - flow.at(points_px[i])).norm());
      }
    }
    flow.sigma_px = std::max(kMinSigma_px, kSigmaOfMedian * upper_median(residuals_px));
    if (iteration == kIterations) break;
    flow.inliers = 0;
    for (std::size_t i = 0; i < points_px.size(); ++i) {
      weights[i] = used[i] == 0 ? 0
                                : tukey_weight((displacements_px[i] - flow.at(points_px[i])).norm(),
                                               flow.sigma_px);
      if (weights[i] > 0) ++flow.inliers;
    }
    fit_weighted(points_px, displacements_px, weights, flow);
  }
  return flow;
}

}  // namespace stillkite
