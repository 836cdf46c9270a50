#include "flow/local_deformation.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

namespace stillkite {
namespace {

constexpr float kMaxDistance_px = 80;

std::pair<int, int> cell_of(const Eigen::Vector2f& at_px) {
  return {static_cast<int>(std::floor(at_px.x() / kMaxDistance_px)),
          static_cast<int>(std::floor(at_px.y() / kMaxDistance_px))};
}

}  // namespace

void LocalDeformation::set_points(const std::vector<Eigen::Vector2f>& points_px) {
  constexpr std::size_t kMaxNeighbours = 12;
  points_px_ = points_px;
  std::map<std::pair<int, int>, std::vector<std::size_t>> cells;
  for (std::size_t i = 0; i < points_px.size(); ++i) cells[cell_of(points_px[i])].push_back(i);
  neighbours_.clear();
  first_neighbour_.assign(1, 0);
  std::vector<std::pair<float, std::size_t>> near;  // squared distance, point
  for (std::size_t i = 0; i < points_px.size(); ++i) {
    near.clear();
    const auto [column, row] = cell_of(points_px[i]);
    for (int k = 0; k < 9; ++k) {
      const auto cell = cells.find({column + k % 3 - 1, row + k / 3 - 1});
      if (cell == cells.end()) continue;
      for (const std::size_t j : cell->second) {
        const float distance2 = (points_px[j] - points_px[i]).squaredNorm();
        if (j != i && distance2 <= kMaxDistance_px * kMaxDistance_px)
          near.emplace_back(distance2, j);
      }
    }
    const std::size_t count = std::min(kMaxNeighbours, near.size());
    std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), near.end());
    for (std::size_t k = 0; k < count; ++k) neighbours_.push_back(near[k].second);
    first_neighbour_.push_back(neighbours_.size());
  }
}

const std::vector<Eigen::Matrix2f>& LocalDeformation::fit(
    const std::vector<Eigen::Vector2f>& displacements_px, const std::vector<unsigned char>& used,
    const AffineFlow& global) {
  constexpr float kStrainScale =
      0.05F;  // typical gradient within one surface relative to the global one
  constexpr float kPrior_px2 =
      20;  // prior weight: (sigma of a displacement / sigma of a gradient)^2
  gradients_.assign(points_px_.size(), global.gradient);
  for (std::size_t i = 0; i < points_px_.size(); ++i) {
    if (used[i] == 0) continue;
    Eigen::Matrix2f normal = kPrior_px2 * Eigen::Matrix2f::Identity();
    Eigen::Matrix2f right = Eigen::Matrix2f::Zero();
    for (std::size_t k = first_neighbour_[i]; k < first_neighbour_[i + 1]; ++k) {
      const std::size_t j = neighbours_[k];
      const Eigen::Vector2f x = points_px_[j] - points_px_[i];
      if (used[j] == 0) continue;
      const Eigen::Vector2f d = displacements_px[j] - displacements_px[i] - global.gradient * x;
      const float weight =
          1 / (1 + d.squaredNorm() / (kStrainScale * kStrainScale * x.squaredNorm() + 1e-6F));
      normal += weight * x * x.transpose();
      right += weight * d * x.transpose();
    }
    gradients_[i] += right * normal.inverse();
  }
  return gradients_;
}

}  // namespace stillkite
