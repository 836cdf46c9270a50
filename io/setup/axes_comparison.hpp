#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "io/dataset/rotation_comparison.hpp"

// Axes of a gyroscope as hypotheses: how much better one explains the rotations of the images than
// another. Bounds: docs/check.md.

namespace stillkite {

inline constexpr double kSameExplained = 0.05;  ///< hypotheses that rotation does not distinguish
inline constexpr double kMinSignificance = 5;   ///< standard deviations, by ten blocks

/// Rotation of an interval by images and gyroscope, rad, less the mean rates.
struct RotationPair {
  Eigen::Vector3d images, gyro;
};

/// `offset_s`: of the log ahead of the images. Intervals that the log does not cover are left out.
[[nodiscard]] std::vector<RotationPair> rotation_pairs(const GyroIntegral& gyro,
                                                       std::span<const ObservedRotation> intervals,
                                                       double offset_s);

/// What better axes explain in addition.
struct AxesGain {
  double explained = 0;  ///< part of the image rotation
  double sigmas = 0;     ///< significance

  [[nodiscard]] bool is_significant() const {
    return explained > kSameExplained && sigmas > kMinSignificance;
  }
};

/// Of `better` over `worse`, each at its best scale: a wrong focal length is no wrong axis.
/// Significance: the larger of the gain's, by the jackknife over blocks, and that of the residuals'
/// ratio. Its logarithm has the variance 4 / n for n degrees of freedom each (F distribution):
/// three axes of each block, since neighbouring residuals are correlated.
[[nodiscard]] AxesGain axes_gain(std::span<const RotationPair> pairs, const Eigen::Matrix3d& better,
                                 const Eigen::Matrix3d& worse);

/// True if the gain is significant.
[[nodiscard]] bool is_better(std::span<const RotationPair> pairs, const Eigen::Matrix3d& better,
                             const Eigen::Matrix3d& worse);

/// Rotation about a second axis, so that a rotation of three degrees of freedom is observable.
[[nodiscard]] bool rotates_about_two_axes(const RotationSums& sums);

/// The 48 signed permutations of three axes; the first is the identity. 24 are rotations.
[[nodiscard]] std::span<const Eigen::Matrix3d> signed_permutations();

}  // namespace stillkite
