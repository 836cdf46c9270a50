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

enum class EstimateSource { flow, reference, fused };
template <>
struct EnumNames<EstimateSource> {
  static constexpr auto value = std::to_array<std::pair<EstimateSource, std::string_view>>(
      {{EstimateSource::flow, "flow"},
       {EstimateSource::reference, "reference"},
       {EstimateSource::fused, "fused"}});
};

enum class EstimateStatus {
  ok,
  gated,      ///< measured, but too far from the last one to be believed at once
  predicted,  ///< nothing was measured; inertia led there, as well as the covariance says
  lost,       ///< nothing was measured: as last known, its covariance grown
};
template <>
struct EnumNames<EstimateStatus> {
  static constexpr auto value = std::to_array<std::pair<EstimateStatus, std::string_view>>(
      {{EstimateStatus::ok, "ok"},
       {EstimateStatus::gated, "gated"},
       {EstimateStatus::predicted, "predicted"},
       {EstimateStatus::lost, "lost"}});
};

enum class DisplacementKind {
  unknown,
  zero,       ///< not told from none
  direction,  ///< a unit vector, the length is not known
  metric,     ///< metres
};
template <>
struct EnumNames<DisplacementKind> {
  static constexpr auto value = std::to_array<std::pair<DisplacementKind, std::string_view>>(
      {{DisplacementKind::unknown, "unknown"},
       {DisplacementKind::zero, "zero"},
       {DisplacementKind::direction, "direction"},
       {DisplacementKind::metric, "metric"}});
};

/// What either estimator tells the controller: where the camera is, seen from where it should be.
struct MotionEstimate {
  Timestamp stamp;  ///< of the exposure
  EstimateSource source = EstimateSource::reference;
  EstimateStatus status = EstimateStatus::lost;

  Eigen::Quaterniond reference_from_camera = Eigen::Quaterniond::Identity();
  Eigen::Matrix3d rotation_covariance = Eigen::Matrix3d::Zero();  ///< rotation vector, reference

  DisplacementKind displacement_kind = DisplacementKind::unknown;
  /// The camera's origin in the reference camera's frame.
  Eigen::Vector3d displacement_in_reference = Eigen::Vector3d::Zero();
  Eigen::Matrix3d displacement_covariance = Eigen::Matrix3d::Zero();  ///< 0: `zero`, `unknown`

  double mean_shift_px = 0;  ///< mean length of the features' way from their reference place
  double parallax_rad = 0;   ///< the way over the distance of what is seen

  std::optional<Twist> twist_in_camera;  ///< its velocity only where the displacement is metric
  ScaleSource scale = ScaleSource::none;
  double scale_age_s = 0;
};

}  // namespace stillkite
