#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace stillkite {

/// Camera motion over a plane. Unit of length: height of the reference camera over the plane.
/// X_current = rotation X_reference + translation; plane: normal . X_reference = 1.
struct PlaneMotion {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  ///< current_from_reference
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();         ///< reference's origin in current
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< unit, towards the ground, in reference

  /// Homography H = R + t n^T: X_current ~ H b for the bearing b = (x, y, 1) of a plane point.
  [[nodiscard]] Eigen::Matrix3d homography() const {
    return rotation.toRotationMatrix() + translation * normal.transpose();
  }
};

/// Increment of a PlaneMotion: t <- exp(w) t + dt, R <- exp(w) R, n <- exp(tilt) n. Order of the
/// eight parameters: dt (heights), w (rad), tilt about the two tilt axes (rad).
using PlaneMotionStep = Eigen::Matrix<double, 8, 1>;
using PlaneMotionMatrix = Eigen::Matrix<double, 8, 8>;

/// Columns: the two rotation axes of the normal, in the reference camera.
using TiltAxes = Eigen::Matrix<double, 3, 2>;

/// Motion after the increment `step`.
[[nodiscard]] PlaneMotion apply(const PlaneMotion& motion, const PlaneMotionStep& step,
                                const TiltAxes& tilt_axes);

}  // namespace stillkite
