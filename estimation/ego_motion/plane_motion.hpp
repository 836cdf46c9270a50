#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace stillkite {

/// The motion of a camera over a plane, all lengths in heights of the reference camera over it:
/// X_current = rotation X_reference + translation, plane normal . X_reference = 1.
struct PlaneMotion {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  ///< current_from_reference
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();         ///< reference's origin in current
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< unit, towards the ground, in reference

  /// H = R + t n^T: X_current ~ H b for the bearing b = (x, y, 1) of a point of the plane.
  [[nodiscard]] Eigen::Matrix3d homography() const {
    return rotation.toRotationMatrix() + translation * normal.transpose();
  }
};

/// Small change of a PlaneMotion: translation t <- exp(w) t + dt, rotation R <- exp(w) R,
/// normal n <- exp(tilt) n. Order of the eight parameters: dt, w, tilt about the two tilt axes.
using PlaneMotionStep = Eigen::Matrix<double, 8, 1>;
using PlaneMotionMatrix = Eigen::Matrix<double, 8, 8>;

/// The two axes, in the reference camera, about which the normal may turn: columns.
using TiltAxes = Eigen::Matrix<double, 3, 2>;

[[nodiscard]] PlaneMotion apply(const PlaneMotion& motion, const PlaneMotionStep& step,
                                const TiltAxes& tilt_axes);

}  // namespace stillkite
