#pragma once

#include <Eigen/Core>
#include <vector>

#include "flow/affine_flow.hpp"

namespace stillkite {

/// How an image is deformed about each of some points, from what their neighbours move by: things
/// nearer to a camera that goes ahead grow faster.
class LocalDeformation {
 public:
  void set_points(const std::vector<Eigen::Vector2f>& points_px);

  /// d(displacement)/d(place) at each point. Neighbours count by how little they move otherwise
  /// than the point itself, for some lie at another depth; where they tell nothing it is `whole`'s.
  const std::vector<Eigen::Matrix2f>& fit(const std::vector<Eigen::Vector2f>& displacements_px,
                                          const std::vector<unsigned char>& used,
                                          const AffineFlow& whole);

 private:
  std::vector<Eigen::Vector2f> points_px_;
  std::vector<std::size_t> neighbours_;  // of one point after the other
  std::vector<std::size_t> first_neighbour_;
  std::vector<Eigen::Matrix2f> gradients_;
};

}  // namespace stillkite
