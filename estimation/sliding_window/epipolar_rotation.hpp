#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <span>

namespace stillkite {

/// Bearings of a point on z = 1 in two images.
struct BearingMatch {
  Eigen::Vector3d first, second;
  double variance = 0;  ///< mean of the two images, of one component
};

/// Normal equations of a rotation (second to first camera) in the epipolar residuals
/// t . (a x R b), their translation direction t eliminated (Kneip and Lynen, "Direct optimization
/// of frame-to-frame rotation", ICCV 2013). Error of the rotation: R_true = R exp(error). Robust:
/// weights by Geman and McClure.
struct RotationEquations {
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
};
[[nodiscard]] RotationEquations epipolar_equations(std::span<const BearingMatch> matches,
                                                   const Eigen::Matrix3d& rotation, bool is_robust);

/// Rotation (second to first camera) by the images; of the two that a plane allows, the one near
/// the initial rotation. Empty with fewer than twelve matches, or if its standard deviation exceeds
/// a tenth of the rotation.
[[nodiscard]] std::optional<Eigen::Quaterniond> epipolar_rotation(
    std::span<const BearingMatch> matches, const Eigen::Quaterniond& initial);

}  // namespace stillkite
