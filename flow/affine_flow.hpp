#pragma once

#include <Eigen/Core>
#include <vector>

namespace stillkite {

/// Global affine motion of an image: displacement_px(x) = offset_px + gradient (x - origin_px).
struct AffineFlow {
  Eigen::Vector2f origin_px = Eigen::Vector2f::Zero();
  Eigen::Vector2f offset_px = Eigen::Vector2f::Zero();
  Eigen::Matrix2f gradient = Eigen::Matrix2f::Zero();
  float sigma_px = 0;  ///< robust standard deviation of the residuals
  int inliers = 0;

  [[nodiscard]] Eigen::Vector2f at(const Eigen::Vector2f& x_px) const {
    return offset_px + gradient * (x_px - origin_px);
  }
};

/// Iteratively reweighted least squares (Tukey biweight) on the points with `used` = 1. Fewer than
/// 8 displacements: their mean, gradient zero.
[[nodiscard]] AffineFlow fit_affine_flow(const std::vector<Eigen::Vector2f>& points_px,
                                         const std::vector<Eigen::Vector2f>& displacements_px,
                                         const std::vector<unsigned char>& used);

}  // namespace stillkite
