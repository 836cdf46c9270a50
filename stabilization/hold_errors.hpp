#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>

#include "geometry/euler.hpp"
#include "stabilization/hold_config.hpp"
#include "stabilization/hold_decision.hpp"

namespace stillkite {

/// First reason for which this input allows no command, or `none`.
[[nodiscard]] HoldReason reason_to_hold(const HoldConfig& config, const HoldInput& input);

/// Position error, reference minus camera, in the station's frame and in the length unit of the
/// estimate's displacement c: -R_station_from_camera R_camera_from_reference c.
[[nodiscard]] Eigen::Vector3d position_error_in_station(
    const MotionEstimate& estimate, const Eigen::Quaterniond& station_from_camera);

/// Velocity of the camera in the station's frame; nullopt without a metric estimate of it.
[[nodiscard]] std::optional<Eigen::Vector3d> velocity_in_station_m_s(
    const MotionEstimate& estimate, const Eigen::Quaterniond& station_from_camera);

/// Yaw error, reference minus camera, about the station's z (left is +), in (-pi, pi]: the twist of
/// the rotation from camera to reference (swing-twist decomposition), so without pitch and roll.
[[nodiscard]] double yaw_error_rad(const MotionEstimate& estimate,
                                   const Eigen::Quaterniond& station_from_camera);

/// Euler angles of the rotation from the reference's axes to the camera's (hold paper, eq. 6-8):
/// theta_x is the roll of the result, theta_y its pitch, theta_z its yaw. theta_y > 0 for a camera
/// that has yawed left.
[[nodiscard]] EulerAngles paper_angles(const MotionEstimate& estimate);

}  // namespace stillkite
