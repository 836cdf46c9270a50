#pragma once

#include <Eigen/Core>

#include "estimation/motion_estimate.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// Displacement from the pose to hold in level axes: forward, left and up as seen from that pose.
struct LevelDisplacement {
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double yaw_rad = 0;  ///< of the body since the pose to hold, left positive
};

/// `world_from_body`: current attitude, z up. Lengths as in `motion`.
[[nodiscard]] LevelDisplacement level_displacement(const MotionEstimate& motion,
                                                   const Eigen::Quaterniond& world_from_body,
                                                   const RigidTransform& body_from_camera);

/// Ellipse of a horizontal displacement: semi-axes, and the angle of the first from forward to
/// left.
struct DisplacementEllipse {
  double major = 0;
  double minor = 0;
  double angle_rad = 0;
};

/// Ellipse that contains the true horizontal displacement with a probability of 95 %.
[[nodiscard]] DisplacementEllipse horizontal_ellipse(const Eigen::Matrix3d& covariance);

}  // namespace stillkite
