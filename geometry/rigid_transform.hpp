#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "geometry/time.hpp"

namespace stillkite {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// b_from_a: x_in_b = rotation * x_in_a + translation; the translation is a's origin in b.
struct RigidTransform {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  [[nodiscard]] RigidTransform inverse() const;
  [[nodiscard]] Eigen::Vector3d operator*(const Eigen::Vector3d& x) const;
  [[nodiscard]] RigidTransform operator*(const RigidTransform& other) const;
};

struct StampedPose {
  Timestamp stamp;
  RigidTransform world_from_body;
};

/// [v]x, the matrix of the cross product: skew(a) * b == a.cross(b).
[[nodiscard]] Eigen::Matrix3d skew(const Eigen::Vector3d& v);

/// Exponential map of SO(3): the rotation by |w| rad about w (Rodrigues).
[[nodiscard]] Eigen::Quaterniond so3_exp(const Eigen::Vector3d& w);

/// Logarithm of SO(3), the rotation vector with |w| <= pi; inverse of so3_exp.
[[nodiscard]] Eigen::Vector3d so3_log(const Eigen::Quaterniond& rotation);

/// Left Jacobian J of SO(3): exp(w + d) ~ exp(J d) exp(w).
[[nodiscard]] Eigen::Matrix3d so3_left_jacobian(const Eigen::Vector3d& w);

/// Angle of the relative rotation, in [0, pi] rad.
[[nodiscard]] double angle_between_rad(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b);

/// Angle between two vectors, in [0, pi] rad.
[[nodiscard]] double angle_between_rad(const Eigen::Vector3d& a, const Eigen::Vector3d& b);

/// Rotation of the smallest angle that maps the direction of `a` to that of `b`; about any axis
/// normal to `a` if they are opposite. Both are non-zero.
[[nodiscard]] Eigen::Quaterniond rotation_between(const Eigen::Vector3d& a,
                                                  const Eigen::Vector3d& b);

/// Interpolated pose: translation linear, rotation slerp; ratio 0: `a`, ratio 1: `b`.
[[nodiscard]] RigidTransform interpolate(const RigidTransform& a, const RigidTransform& b,
                                         double ratio);

}  // namespace stillkite
