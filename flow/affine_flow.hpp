#pragma once

#include <Eigen/Core>
#include <vector>

namespace stillkite {

/// displacement_px(x) = offset_px + gradient x about the origin `about_px`: how an image moves as
/// a whole.
struct AffineFlow {
  Eigen::Vector2f about_px = Eigen::Vector2f::Zero();
  Eigen::Vector2f offset_px = Eigen::Vector2f::Zero();
  Eigen::Matrix2f gradient = Eigen::Matrix2f::Zero();
  float deviation_px = 0;  ///< robust standard deviation of the displacements from it
  int inliers = 0;

  [[nodiscard]] Eigen::Vector2f at(const Eigen::Vector2f& x_px) const {
    return offset_px + gradient * (x_px - about_px);
  }
};

/// Robust fit by reweighted least squares (Tukey). Fewer than 8 displacements give their mean.
[[nodiscard]] AffineFlow fit_affine_flow(const std::vector<Eigen::Vector2f>& points_px,
                                         const std::vector<Eigen::Vector2f>& displacements_px,
                                         const std::vector<unsigned char>& used);

}  // namespace stillkite
