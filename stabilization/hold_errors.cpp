#include "stabilization/hold_errors.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "geometry/time.hpp"

namespace stillkite {
namespace {

bool is_rotation(const Eigen::Quaterniond& q) {
  return q.coeffs().allFinite() && std::abs(q.norm() - 1) < 1e-3;
}

bool is_finite(const TetherState& tether) {
  return std::isfinite(tether.length_m) && std::isfinite(tether.elevation_rad) &&
         std::isfinite(tether.azimuth_rad);
}

bool is_finite(const MotionEstimate& estimate) {
  return is_rotation(estimate.reference_from_camera) &&
         estimate.displacement_in_reference.allFinite() && std::isfinite(estimate.mean_shift_px) &&
         std::isfinite(estimate.parallax_rad) &&
         (!estimate.twist_in_camera || estimate.twist_in_camera->vector().allFinite());
}

// Root of the position covariance's trace; infinite if the estimate is not metric.
double position_sigma_m(const MotionEstimate& estimate) {
  if (estimate.displacement_kind != DisplacementKind::metric) {
    return std::numeric_limits<double>::infinity();
  }
  return std::sqrt(estimate.displacement_covariance.trace());
}

bool is_current(Timestamp stamp, Timestamp now, double max_age_s) {
  const double age_s = seconds_between(stamp, now);
  return age_s >= 0 && age_s <= max_age_s;
}

// Plausible range of a measurement; wider than the command limits.
bool is_possible(const VehicleLimits& limits, const TetherState& tether) {
  constexpr double kMaxAzimuth_rad = 1e3;
  constexpr double kElevationMargin_rad = std::numbers::pi / 4;
  return tether.length_m >= 0 && tether.length_m <= 2 * limits.max_length_m &&
         tether.elevation_rad >= -kElevationMargin_rad &&
         tether.elevation_rad <= std::numbers::pi + kElevationMargin_rad &&
         std::abs(tether.azimuth_rad) <= kMaxAzimuth_rad;
}

}  // namespace

HoldReason reason_to_hold(const HoldConfig& config, const HoldInput& input) {
  if (input.withheld != HoldReason::none) return input.withheld;
  if (!input.estimate) return HoldReason::no_estimate;
  const MotionEstimate& estimate = *input.estimate;
  if (estimate.status == EstimateStatus::lost) return HoldReason::estimate_lost;
  if (estimate.status == EstimateStatus::predicted &&
      !(position_sigma_m(estimate) <= config.max_predicted_sigma_m)) {
    return HoldReason::estimate_lost;
  }
  if (estimate.status == EstimateStatus::gated) return HoldReason::estimate_gated;
  if (!is_current(estimate.stamp, input.now, config.max_estimate_age_s)) {
    return HoldReason::estimate_stale;
  }
  if (!is_finite(estimate) || !is_rotation(input.station_from_camera)) {
    return HoldReason::not_finite;
  }
  if (!input.tether) return HoldReason::no_tether_reading;
  if (!is_current(input.tether->stamp, input.now, config.max_tether_age_s)) {
    return HoldReason::tether_stale;
  }
  if (!input.tether->taut && config.mode == HoldMode::paper) return HoldReason::tether_slack;
  if (!is_finite(input.tether->tether)) return HoldReason::not_finite;
  return is_possible(config.limits, input.tether->tether) ? HoldReason::none
                                                          : HoldReason::tether_out_of_range;
}

Eigen::Vector3d position_error_in_station(const MotionEstimate& estimate,
                                          const Eigen::Quaterniond& station_from_camera) {
  const Eigen::Quaterniond station_from_reference =
      station_from_camera * estimate.reference_from_camera.conjugate();
  return -(station_from_reference * estimate.displacement_in_reference);
}

std::optional<Eigen::Vector3d> velocity_in_station_m_s(
    const MotionEstimate& estimate, const Eigen::Quaterniond& station_from_camera) {
  const bool is_metric = estimate.displacement_kind == DisplacementKind::metric;
  if (!is_metric || !estimate.twist_in_camera) return std::nullopt;
  return Eigen::Vector3d(station_from_camera * estimate.twist_in_camera->velocity_m_s);
}

double yaw_error_rad(const MotionEstimate& estimate,
                     const Eigen::Quaterniond& station_from_camera) {
  const Eigen::Quaterniond rotation_to_reference = station_from_camera *
                                                   estimate.reference_from_camera.conjugate() *
                                                   station_from_camera.conjugate();
  return wrap_angle_rad(2 * std::atan2(rotation_to_reference.z(), rotation_to_reference.w()));
}

EulerAngles paper_angles(const MotionEstimate& estimate) {
  return to_euler(estimate.reference_from_camera.conjugate());
}

}  // namespace stillkite
