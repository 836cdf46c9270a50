#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <string_view>
#include <utility>

#include "estimation/twist.hpp"
#include "estimation/verdict.hpp"
#include "geometry/fields.hpp"
#include "geometry/time.hpp"

namespace stillkite {

/// Estimator that produced an estimate.
enum class EstimateSource { flow, reference, fused };
template <>
struct EnumNames<EstimateSource> {
  static constexpr auto value = std::to_array<std::pair<EstimateSource, std::string_view>>(
      {{EstimateSource::flow, "flow"},
       {EstimateSource::reference, "reference"},
       {EstimateSource::fused, "fused"}});
};

/// Validity of an estimate.
enum class EstimateStatus {
  ok,         ///< measured
  gated,      ///< measured, but rejected by the rotation gate
  predicted,  ///< no measurement; propagated by the IMU, covariance consistent
  lost,       ///< no measurement; last estimate with inflated covariance
};
template <>
struct EnumNames<EstimateStatus> {
  static constexpr auto value = std::to_array<std::pair<EstimateStatus, std::string_view>>(
      {{EstimateStatus::ok, "ok"},
       {EstimateStatus::gated, "gated"},
       {EstimateStatus::predicted, "predicted"},
       {EstimateStatus::lost, "lost"}});
};

/// Observability of the displacement between reference and current camera.
enum class DisplacementKind {
  unknown,
  zero,       ///< not significantly different from zero
  direction,  ///< unit vector; the length is not observable
  metric,     ///< in metres
};
template <>
struct EnumNames<DisplacementKind> {
  static constexpr auto value = std::to_array<std::pair<DisplacementKind, std::string_view>>(
      {{DisplacementKind::unknown, "unknown"},
       {DisplacementKind::zero, "zero"},
       {DisplacementKind::direction, "direction"},
       {DisplacementKind::metric, "metric"}});
};

/// Relative pose of the camera to the reference pose, the controller's input.
///
/// Rotation covariances are those of a rotation vector in the reference frame, rad^2. Displacement
/// covariances have the unit of the displacement squared.
struct MotionEstimate {
  Timestamp stamp;  ///< time of exposure
  EstimateSource source = EstimateSource::reference;
  EstimateStatus status = EstimateStatus::lost;

  Eigen::Quaterniond reference_from_camera = Eigen::Quaterniond::Identity();
  Eigen::Matrix3d rotation_covariance = Eigen::Matrix3d::Zero();

  DisplacementKind displacement_kind = DisplacementKind::unknown;
  /// Origin of the camera in the reference camera's frame.
  Eigen::Vector3d displacement_in_reference = Eigen::Vector3d::Zero();
  /// Zero for the kinds `zero` and `unknown`.
  Eigen::Matrix3d displacement_covariance = Eigen::Matrix3d::Zero();

  double mean_shift_px = 0;  ///< mean feature displacement from the reference image
  double parallax_rad = 0;   ///< displacement over scene depth

  std::optional<Twist> twist_in_camera;  ///< velocity valid only for a metric displacement
  ScaleSource scale = ScaleSource::none;
  double scale_age_s = 0;  ///< since the last scale measurement
};

}  // namespace stillkite
