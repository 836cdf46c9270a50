#include "geometry/rigid_transform.hpp"

#include <algorithm>
#include <cmath>

namespace stillkite {

RigidTransform RigidTransform::inverse() const {
  const Eigen::Quaterniond inverse_rotation = rotation.conjugate();
  return {inverse_rotation, -(inverse_rotation * translation)};
}

Eigen::Vector3d RigidTransform::operator*(const Eigen::Vector3d& x) const {
  return rotation * x + translation;
}

RigidTransform RigidTransform::operator*(const RigidTransform& other) const {
  return {(rotation * other.rotation).normalized(), rotation * other.translation + translation};
}

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Eigen::Quaterniond so3_exp(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  // Taylor series of sin(a/2)/a for small angles
  const double scale = angle < 1e-6 ? 0.5 - angle * angle / 48.0 : std::sin(0.5 * angle) / angle;
  const Eigen::Vector3d xyz = scale * w;
  return Eigen::Quaterniond(std::cos(0.5 * angle), xyz.x(), xyz.y(), xyz.z());
}

Eigen::Vector3d so3_log(const Eigen::Quaterniond& rotation) {
  // q and -q are the same rotation: use the one with |w| <= pi
  const double sign = rotation.w() < 0 ? -1.0 : 1.0;
  const double w = sign * rotation.w();
  const Eigen::Vector3d xyz = sign * rotation.vec();
  const double sine = xyz.norm();
  const double scale = sine < 1e-9 ? 2.0 / w : 2.0 * std::atan2(sine, w) / sine;
  return scale * xyz;
}

Eigen::Matrix3d so3_left_jacobian(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  const Eigen::Matrix3d W = skew(w);
  if (angle < 1e-5) return Eigen::Matrix3d::Identity() + 0.5 * W;
  const double square = angle * angle;
  return Eigen::Matrix3d::Identity() + (1.0 - std::cos(angle)) / square * W +
         (angle - std::sin(angle)) / (square * angle) * W * W;
}

double angle_between_rad(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  return so3_log(a.conjugate() * b).norm();
}

double angle_between_rad(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// Half-angle formula: q = (a x b / s, s / 2), s = sqrt(2 (1 + a.b)), for unit vectors. Eigen's
// FromTwoVectors is the same, but costs each source that uses it eight seconds of compilation.
Eigen::Quaterniond rotation_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d from = a.normalized();
  const Eigen::Vector3d to = b.normalized();
  const double cosine = to.dot(from);
  constexpr double kOppositeCosine = -1 + 1e-12;
  if (cosine < kOppositeCosine) {
    const Eigen::Vector3d axis = from.unitOrthogonal();
    return {0, axis.x(), axis.y(), axis.z()};
  }
  const double s = std::sqrt((1 + cosine) * 2);
  const Eigen::Vector3d xyz = from.cross(to) * (1 / s);
  return {s * 0.5, xyz.x(), xyz.y(), xyz.z()};
}

RigidTransform interpolate(const RigidTransform& a, const RigidTransform& b, double ratio) {
  return {a.rotation.slerp(ratio, b.rotation),
          (1.0 - ratio) * a.translation + ratio * b.translation};
}

}  // namespace stillkite
