#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>

#include "geometry/euler.hpp"
#include "stabilization/hold_config.hpp"
#include "stabilization/hold_decision.hpp"

namespace stillkite {

/// Why no command may follow from this input, or `none`; the first that holds.
[[nodiscard]] HoldReason reason_to_hold(const HoldConfig& config, const HoldInput& input);

/// From the camera to where it should be, in the station's frame, of the length that the estimate
/// gives its displacement c: -R_station_from_camera R_camera_from_reference c.
[[nodiscard]] Eigen::Vector3d way_home_in_station(const MotionEstimate& estimate,
                                                  const Eigen::Quaterniond& station_from_camera);

/// The camera's velocity in the station's frame; nothing where the estimate knows none in metres.
[[nodiscard]] std::optional<Eigen::Vector3d> velocity_in_station_m_s(
    const MotionEstimate& estimate, const Eigen::Quaterniond& station_from_camera);

/// The turn about the station's z (left is +) that the camera is from the reference's attitude:
/// the twist of the rotation that takes it there, in (-pi, pi]. Pitch and roll do not enter.
[[nodiscard]] double turn_home_rad(const MotionEstimate& estimate,
                                   const Eigen::Quaterniond& station_from_camera);

/// Hold paper, eq. (6)-(8), of the rotation that takes the reference's axes to the camera's:
/// theta_x is the roll of the result, theta_y its pitch, theta_z its yaw. A camera that has turned
/// left has theta_y > 0.
[[nodiscard]] EulerAngles paper_angles(const MotionEstimate& estimate);

}  // namespace stillkite
