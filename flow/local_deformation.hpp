#pragma once

#include <Eigen/Core>
#include <vector>

#include "flow/affine_flow.hpp"

namespace stillkite {

/// Local displacement gradient at each feature, estimated from its neighbours' displacements: under
/// forward motion the image scale change depends on depth.
class LocalDeformation {
 public:
  void set_points(const std::vector<Eigen::Vector2f>& points_px);

  /// d(displacement)/d(position) at each point: regularized least squares over at most 12
  /// neighbours within 80 px. The weight decreases with the relative displacement, which rejects
  /// other depths. Prior: the gradient of `global`; returned unchanged for points with `used` = 0.
  const std::vector<Eigen::Matrix2f>& fit(const std::vector<Eigen::Vector2f>& displacements_px,
                                          const std::vector<unsigned char>& used,
                                          const AffineFlow& global);

 private:
  std::vector<Eigen::Vector2f> points_px_;
  std::vector<std::size_t> neighbours_;  // concatenated over the points
  std::vector<std::size_t> first_neighbour_;
  std::vector<Eigen::Matrix2f> gradients_;
};

}  // namespace stillkite
