#pragma once

#include <Eigen/Core>

#include "geometry/rigid_transform.hpp"
#include "geometry/time.hpp"

namespace stillkite {

/// Linear and angular velocity of the camera, both expressed in the camera frame.
struct Twist {
  Eigen::Vector3d velocity_m_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_rate_rad_s = Eigen::Vector3d::Zero();

  [[nodiscard]] Vector6d vector() const {
    Vector6d v;
    v << velocity_m_s, angular_rate_rad_s;
    return v;
  }
  [[nodiscard]] static Twist from_vector(const Vector6d& v) { return {v.head<3>(), v.tail<3>()}; }
};

/// The camera's motion half way between the frame before and the one at `stamp`.
struct StampedTwist {
  Timestamp stamp;
  Twist twist;
};

}  // namespace stillkite
