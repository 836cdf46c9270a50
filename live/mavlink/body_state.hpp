#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>

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
  std::optional<double> ground_distance_m;       ///< along the body's down axis; empty: not above
  std::int8_t quality = 0;                       ///< percentage of inliers, 1 to 100
  std::uint8_t reset_counter = 0;
};

/// State of a gravity-aligned estimate. Velocity and rate are the mean over the interval that ends
/// at the stamp. Empty unless the frame is measured (`ok` or `still`), has a source of scale, and
/// all values are finite: PX4 uses ODOMETRY of any quality by default (EKF2_EV_QMIN 0), and
/// ArduPilot before VISO_QUAL_MIN does, too.
[[nodiscard]] std::optional<BodyState> body_state(const NavigationEstimate& estimate,
                                                  const RigidTransform& body_from_camera,
                                                  std::uint8_t reset_counter);

}  // namespace stillkite::mavlink
