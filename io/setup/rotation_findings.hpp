#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <span>
#include <string>

#include "io/dataset/rotation_comparison.hpp"
#include "io/setup/imu_findings.hpp"
#include "io/setup/setup_finding.hpp"

// Questions about a gyroscope and the camera's mount, by the rotations that the images measure.
// Bounds: docs/check.md.

namespace stillkite {

struct RotationEvidence {
  const TimeSeries<Eigen::Vector3d>& gyro;     ///< in body axes as configured, not empty
  std::span<const ObservedRotation> observed;  ///< by the images, in body axes as configured
  Eigen::Quaterniond body_from_camera = Eigen::Quaterniond::Identity();  ///< configured
  Eigen::Quaterniond body_from_sensor = Eigen::Quaterniond::Identity();  ///< configured
  double time_offset_s = 0;                                              ///< configured
  std::string section = "imu";                                           ///< imu or gyro
  std::optional<Eigen::Vector3d> measured_up_in_body;  ///< specific force, body axes as configured
  Eigen::Vector3d initial_up_in_body = Eigen::Vector3d::UnitZ();  ///< by the initial attitude
  bool has_ground_in_view = false;  ///< the images follow the ground plane of the initial attitude
  Timestamp first, last;            ///< images examined
};

/// Result of the comparison, for the questions that depend on it.
struct RotationResult {
  SetupFindings findings;
  Eigen::Vector3d gyro_bias_rad_s = Eigen::Vector3d::Zero();  ///< zero if not measured
  /// Axes of the IMU that agree with images and gravity, if these are not the configured ones.
  Eigen::Matrix3d body_from_configured = Eigen::Matrix3d::Identity();
  bool is_consistent = false;  ///< images and gyroscope agree as configured, also in time
};

/// Rates, axes, mount, mirrored images, clock and focal length. Accuses only if another hypothesis
/// explains the rotations significantly better.
[[nodiscard]] RotationResult rotation_findings(const RotationEvidence& evidence);

}  // namespace stillkite
