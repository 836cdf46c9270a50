#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>

#include "geometry/rigid_transform.hpp"
#include "navigation/navigation_estimate.hpp"

namespace stillkite::mavlink {

/// State of the body in MAVLink's axes (forward, right, down), metric.
struct BodyState {
  Timestamp stamp;  ///< local monotonic clock
  Eigen::Vector3d position_in_local_m = Eigen::Vector3d::Zero();
  Eigen::Quaterniond local_from_body = Eigen::Quaterniond::Identity();
  Matrix6d pose_covariance = Matrix6d::Zero();  ///< (position, rotation vector), both in local axes
  Eigen::Vector3d velocity_in_body_m_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_rate_in_body_rad_s = Eigen::Vector3d::Zero();
  Matrix6d twist_covariance = Matrix6d::Zero();  ///< (velocity, angular rate), both in body axes
  double ground_distance_m = 0;                  ///< along the body's down axis
  /// 1 to 100: percentage of inliers; -1: the frame is not measured.
  std::int8_t quality = -1;
  std::uint8_t reset_counter = 0;
};

/// State of a gravity-aligned estimate with a source of scale. Velocity and rate are the mean over
/// the interval that ends at the stamp. Precondition: the scale is not `none`.
[[nodiscard]] BodyState body_state(const NavigationEstimate& estimate,
                                   const RigidTransform& body_from_camera,
                                   std::uint8_t reset_counter);

}  // namespace stillkite::mavlink
