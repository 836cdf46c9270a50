#pragma once

#include <Eigen/Core>

#include "geometry/rigid_transform.hpp"
#include "geometry/time.hpp"

namespace stillkite {

/// Linear velocity v and angular rate w of a camera, both in the camera frame.
struct Twist {
  Eigen::Vector3d velocity_m_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_rate_rad_s = Eigen::Vector3d::Zero();

  /// (v, w).
  [[nodiscard]] Vector6d vector() const {
    Vector6d v;
    v << velocity_m_s, angular_rate_rad_s;
    return v;
  }
  [[nodiscard]] static Twist from_vector(const Vector6d& v) { return {v.head<3>(), v.tail<3>()}; }
};

/// Mean twist over a frame interval, in the camera frame at its middle. `stamp`: end of the
/// interval.
struct StampedTwist {
  Timestamp stamp;
  Twist twist;
};

}  // namespace stillkite
