#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>

#include "estimation/motion_estimate.hpp"
#include "estimation/verdict.hpp"
#include "geometry/time.hpp"

namespace stillkite {

/// Position and velocity in metres, with their source of scale. The covariances exclude the error
/// of an initial height, an unknown constant factor, until a sensor measures the height.
struct MetricState {
  Eigen::Vector3d position_in_world_m = Eigen::Vector3d::Zero();     ///< of the body
  Eigen::Matrix3d position_covariance_m2 = Eigen::Matrix3d::Zero();  ///< in W
  /// Velocity of the camera, mean over the interval that ends at the stamp (mode paper: filtered
  /// value). In W, and in C in the middle of the interval.
  Eigen::Vector3d velocity_in_world_m_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_in_camera_m_s = Eigen::Vector3d::Zero();
  Eigen::Matrix3d velocity_covariance_m2_s2 = Eigen::Matrix3d::Zero();  ///< in C
  ScaleSource scale = ScaleSource::none;                                ///< never `none`
  double scale_age_s = 0;  ///< since the last reading of that source
};

/// Position and velocity in initial heights of the camera above the ground: no source of scale.
struct RelativeState {
  Eigen::Vector3d position_in_world_heights = Eigen::Vector3d::Zero();    ///< of the body
  Eigen::Vector3d velocity_in_world_heights_s = Eigen::Vector3d::Zero();  ///< of the camera
};

/// Pose of the camera relative to the reference image (hold paper, section III).
struct ReferencePose {
  Timestamp stamp;                 ///< of the reference image
  bool on_first_reference = true;  ///< false: a later image is the reference
  Eigen::Quaterniond reference_from_camera = Eigen::Quaterniond::Identity();
  Eigen::Matrix3d rotation_covariance_rad2 =
      Eigen::Matrix3d::Zero();  ///< rotation vector, in the reference camera
  DisplacementKind displacement = DisplacementKind::unknown;
  /// Origin of the camera in the reference camera's frame; set for the kind `metric`.
  std::optional<Eigen::Vector3d> displacement_in_reference_m;
  /// Unit vector to that origin; set for the kind `direction`.
  std::optional<Eigen::Vector3d> direction_in_reference;
  /// Of the displacement or of the direction, in the reference camera; 0 for other kinds.
  Eigen::Matrix3d displacement_covariance = Eigen::Matrix3d::Zero();
};

/// State at an image's stamp. Frames (docs/notation.md): W world, z up by gravity, ground at z = 0;
/// B body, x forward, y left, z up; C camera, x right, y down, z forward. The pose is predicted
/// unless `is_measured(verdict)`; its covariance then grows.
struct Estimate {
  Timestamp stamp;
  std::int64_t frame_index = 0;  ///< number of the image, from 0
  Verdict verdict = Verdict::first_frame;
  EstimateSource source = EstimateSource::flow;  ///< estimator that produced it

  Eigen::Quaterniond world_from_body = Eigen::Quaterniond::Identity();
  Eigen::Matrix3d attitude_covariance_rad2 = Eigen::Matrix3d::Zero();  ///< rotation vector, in W
  Eigen::Vector3d angular_rate_in_camera_rad_s = Eigen::Vector3d::Zero();     ///< interval as above
  Eigen::Matrix3d angular_rate_covariance_rad2_s2 = Eigen::Matrix3d::Zero();  ///< in C

  std::optional<MetricState> metric;       ///< empty without a source of scale
  std::optional<RelativeState> relative;   ///< empty if metric, or if no length is measured
  std::optional<ReferencePose> reference;  ///< empty unless measured in this image
};

}  // namespace stillkite
