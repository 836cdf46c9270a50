#pragma once

#include <Eigen/Geometry>

#include "geometry/angle.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// Rotation body_from_camera of a nadir camera with the image top towards the nose:
/// image right is -y of the body, image down is -x, the optical axis -z.
[[nodiscard]] inline Eigen::Quaterniond camera_looking_down() {
  Eigen::Matrix3d R;
  R << 0, -1, 0, -1, 0, 0, 0, 0, -1;
  return Eigen::Quaterniond(R);
}

/// body_from_camera of a camera at the body origin. `forward_tilt_deg`: angle of the optical axis
/// from nadir towards the nose; 90 degrees points forward.
[[nodiscard]] inline RigidTransform camera_raised_forward(double forward_tilt_deg) {
  const Eigen::AngleAxisd tilt(-forward_tilt_deg * kDegree, Eigen::Vector3d::UnitY());
  return {tilt * camera_looking_down(), Eigen::Vector3d::Zero()};
}

}  // namespace stillkite
