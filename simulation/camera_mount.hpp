#pragma once

#include <Eigen/Geometry>

namespace stillkite {

/// body_from_camera of a camera that looks straight down with the picture's top towards the nose:
/// image right is -y of the body, image down is -x, the optical axis -z.
[[nodiscard]] inline Eigen::Quaterniond camera_looking_down() {
  Eigen::Matrix3d R;
  R << 0, -1, 0, -1, 0, 0, 0, 0, -1;
  return Eigen::Quaterniond(R);
}

}  // namespace stillkite
